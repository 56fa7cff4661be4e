"""The writers of the generated pages, one a page."""
