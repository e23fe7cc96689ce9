"""A controller on the network, ours or another, as a source of the page.

`door.ConnectedController` holds the connections, once for all pages; `source.ConnectedSource` is what one page talks to.
"""
