"""The live view: measured motion, the model's motion and buttons on a page in the browser. It does not use ROS.

In: samples, estimates and diagnoses as they arrive. Out: a page, and what its buttons ask for.
Begin with ``board`` (state of rig and jobs), then ``scope`` (samples and simulation), ``page`` and ``server``.

The page is made with Bokeh. It sends arrays in binary form, its server brings all scripts (no network is needed), it
adds 8 MB to what the reports need, and it has been maintained for more than ten years. NiceGUI brings 49 packages
(24 MB) and sends curves as JSON; Panel is Bokeh with pandas and a dozen more packages (77 MB).
"""

from msd_ident.live.board import Board, Cause, Diagnosed, Estimated, Job, Row
from msd_ident.live.scope import Scope
from msd_ident.live.shadow import Beside, model_of

__all__ = ["Beside", "Board", "Cause", "Diagnosed", "Estimated", "Job", "Row", "Scope", "model_of"]
