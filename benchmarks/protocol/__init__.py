"""An outside client of the language server, written from the specification of the protocol (3.17, 3.18) alone.

It holds the server to the life cycle, the base protocol, positions in all encodings, edits, and what it offers. Nothing here uses
the libraries of the server; a document is modelled by the text of the specification.
"""
