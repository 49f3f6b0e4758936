"""``epg connect --terminal``: the page's questions as lines of text."""
