"""A controller on the network, ours or another, as a source of the page.

`target.find_target` says which one, `controller.ConnectedController` holds its connections, once for all pages, and
`source.ConnectedSource` is what one page talks to.
"""
