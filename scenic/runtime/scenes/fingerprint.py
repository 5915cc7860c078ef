"""Digest of a scenario's graph and domain: equal digests sample equal scenes on equal versions of the libraries."""

import hashlib

from scenic.graph.domain import Domain
from scenic.graph.node import Graph

__all__ = ["fingerprint"]


def fingerprint(graph: Graph, domain: Domain) -> str:
    """SHA-256 in hexadecimal of all nodes (operations, kinds, operands, addresses, constant numbers) and of the domain."""
    digest = hashlib.sha256()
    for node in graph.nodes:
        operands = [graph.index[operand] for operand in node.operands]
        address = graph.address(node) if node.is_drawn else None
        digest.update(f"{node.operation.name};{node.kind.value};{operands};{address};".encode())
        if node.is_constant and not node.kind.is_boxed:
            digest.update(node.payload.column.tobytes())
    for part in (domain, *domain.factors):
        digest.update(part.lower.tobytes())
        digest.update(part.upper.tobytes())
    for one in domain.finite:
        digest.update(one.digest())
    return digest.hexdigest()
