"""Sphinx's settings for the manual; make_manual.py puts its sources together."""

import os

project = "haptolith"
author = "the haptolith developers"
copyright = author  # pylint: disable=redefined-builtin
version = release = os.environ["HAPTOLITH_VERSION"]

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton"]
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence", "deflist"]
primary_domain = "c"
highlight_language = "none"
nitpick_ignore_regex = [("c:identifier", r"u?int\d+_t"), ("py:.*", r"(haptolith\.safety|haptolith\.scene|haptolith\.loop|numpy|np|npt|os|typing|ctypes)\..*|optional|array_like")]
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"

exclude_patterns = ["doctrees"]

html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["manual.css"]
html_title = f"haptolith {version}"
html_copy_source = False
html_show_sphinx = False
copybutton_prompt_text = r"\$ |>>> "
copybutton_prompt_is_regexp = True
