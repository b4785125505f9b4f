"""Sphinx settings; the pages are MyST Markdown, warnings are errors."""

import vasculo

project = "vasculo"
author = "the vasculo developers"
project_copyright = "2026, the vasculo developers"
release = version = vasculo.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax", "sphinx.ext.viewcode"]
myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence"]
myst_heading_anchors = 3
autodoc_typehints = "none"
autodoc_member_order = "bysource"
napoleon_use_rtype = False
html_theme = "furo"
html_title = "vasculo"
exclude_patterns = ["_build"]
nitpicky = False
