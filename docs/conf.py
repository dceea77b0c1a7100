"""The site: `python -m sphinx -W docs site`, with febkit[docs]. Pages are Markdown, the reference is docstrings."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

from febkit import __version__

project, author, release = "febkit", "the authors of febkit", __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton", "made", "docstrings"]
exclude_patterns = ["_ext"]
templates_path: list[str] = []
html_theme = "furo"
html_title = f"febkit {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = html_show_copyright = False
html_copy_source = False
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
autodoc_member_order = "bysource"
autodoc_typehints = "none"
python_maximum_signature_line_length = 88
pygments_style, pygments_dark_style = "friendly", "monokai"
copybutton_exclude = ".linenos, .gp, .go"
