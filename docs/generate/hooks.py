"""What MkDocs calls: generated pages and their places in the contents, tables and numbers in written pages."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent))  # MkDocs takes it off again; the pages import each other later

import architecture  # noqa: E402
import command_page  # noqa: E402
import docs_equations  # noqa: E402
import docs_values  # noqa: E402
import effect_pages  # noqa: E402
import export_tables  # noqa: E402
import ros_tables  # noqa: E402
import tuning_tables  # noqa: E402
from mkdocs.config.defaults import MkDocsConfig  # noqa: E402
from mkdocs.exceptions import PluginError  # noqa: E402
from mkdocs.structure.files import File, Files  # noqa: E402

#: Written by studies (`make blind` and others): in the contents where they are there.
OPTIONAL = ("planning.md", "reliability.md", "accuracy.md", "blind-study.md", "blind-design.md")
_TABLE = re.compile(r"^<!-- (message|parameters|export|house|tuning): (\S+) -->$", re.MULTILINE)
_TABLES = {
    "message": ros_tables.message,
    "parameters": ros_tables.parameters,
    "export": export_tables.written,
    "house": architecture.written,
    "tuning": tuning_tables.written,
}


def generated() -> dict[str, str]:
    """Path below docs → Markdown of every page that nobody writes."""
    return {"cli.md": command_page.page(), **effect_pages.pages()}


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Equations as MathML; the contents with effects in and absent studies out."""
    fence = {"name": "math", "class": "math", "format": docs_equations.block}
    config.mdx_configs.setdefault("pymdownx.superfences", {})["custom_fences"] = [fence]
    there = Path(config.docs_dir)
    config.nav = [_section(entry, there) for entry in config.nav or []]
    return config


def _section(entry: Any, there: Path) -> Any:
    if not isinstance(entry, dict):
        return entry
    ((title, pages),) = entry.items()
    if isinstance(pages, str):
        return entry
    kept = [page for page in pages if page not in OPTIONAL or (there / page).exists()]
    if title == "Effects":
        kept += [page for page in effect_pages.pages() if page not in kept]
    return {title: kept}


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Generated pages among the written ones."""
    for path, text in generated().items():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, config: MkDocsConfig, files: Files) -> str:
    """Numbers of the code and tables put in; links to studies that are not there taken out."""
    try:
        text = docs_values.filled(markdown)
        text = _TABLE.sub(lambda found: _TABLES[found[1]](found[2]), text)
    except (ImportError, AttributeError, OSError) as error:
        raise PluginError(f"{page.file.src_path}: {error}; run it with `make docs`, where ROS is") from error
    for absent in OPTIONAL:
        if files.get_file_from_path(absent) is None:
            text = re.sub(rf"\[([^\]]+)\]\((?:\.\./)?{re.escape(absent)}[^)]*\)", r"\1", text)
    return text
