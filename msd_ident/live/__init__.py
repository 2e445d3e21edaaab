"""The live view: what the rig does, the model beside it, and buttons, on a page in the browser. Knows no ROS.

``scope`` keeps the samples and runs the model beside them, ``board`` keeps what is known and being done, ``page`` shows
both, ``server`` serves the page. Whoever has the data fills scope and board and does what the buttons ask for.

The page is made with Bokeh. Reasons: arrays go to the browser as they are, without becoming text; its server has all
of its scripts on board, so that no network is needed; it asks for 8 MB beyond what the reports need anyway; and it has
been kept for more than ten years. NiceGUI brings 49 packages (24 MB) and sends curves as JSON; Panel is Bokeh with
pandas and a dozen more (77 MB).
"""

from msd_ident.live.board import Board, Cause, Diagnosed, Estimated, Job, Row
from msd_ident.live.scope import Scope
from msd_ident.live.shadow import Beside, model_of

__all__ = ["Beside", "Board", "Cause", "Diagnosed", "Estimated", "Job", "Row", "Scope", "model_of"]
