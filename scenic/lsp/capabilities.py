"""What the server offers, as exactly as the protocol lets it say; and what it asks the client to report."""

from typing import Final

from scenic.ide.semantic_tokens import MODIFIERS, TYPES
from scenic.lsp.convert import Json
from scenic.lsp.session import Client

__all__ = ["FIX_ALL", "ORGANIZE", "SAMPLE", "SIMULATE", "WATCHED", "capabilities", "registrations"]

FIX_ALL: Final = "source.fixAll.scenic"
"""The kind of the action that makes all repairs of a document, which editors can make when they save it."""

ORGANIZE: Final = "source.organizeImports"
"""The kind of the action that puts the imports of a document in order."""

SAMPLE: Final = "scenic.sample"
"""The command that runs a program; its arguments are the document's address and maybe an object with options."""

SIMULATE: Final = "scenic.simulate"
"""The command that simulates a program, with the same arguments; it takes the program as it was saved."""

WATCHED: Final = ("**/*.scenic", "**/*.sc", "**/*.py", "**/pyproject.toml")
"""The files whose changes on the disk matter."""

_FILES: Final = (
    {"scheme": "file", "pattern": {"glob": "**/*.{scenic,sc,py}", "matches": "file"}},
    {"scheme": "file", "pattern": {"glob": "**", "matches": "folder"}},
)
"""The files and folders of which it matters what they are called."""

_INCREMENTAL: Final = 2


def capabilities(client: Client) -> Json:
    """What is offered to a client."""
    return {
        "positionEncoding": client.encoding.value,
        "textDocumentSync": {
            "openClose": True,
            "change": _INCREMENTAL,
            "save": {"includeText": False},
        },
        "completionProvider": {
            "triggerCharacters": [".", " ", ",", "(", '"', "'", "/"],
            "resolveProvider": True,
        },
        "hoverProvider": True,
        "signatureHelpProvider": {
            "triggerCharacters": ["(", ","],
            "retriggerCharacters": ["=", ")"],
        },
        "declarationProvider": True,
        "definitionProvider": True,
        "typeDefinitionProvider": True,
        "implementationProvider": True,
        "referencesProvider": {"workDoneProgress": True},
        "documentHighlightProvider": True,
        "documentSymbolProvider": True,
        "workspaceSymbolProvider": {"resolveProvider": True, "workDoneProgress": True},
        "codeActionProvider": {
            "codeActionKinds": ["quickfix", FIX_ALL, ORGANIZE],
            "resolveProvider": True,
        }
        if client.has("textDocument", "codeAction", "codeActionLiteralSupport")
        or not client.has("textDocument", "codeAction")
        else True,
        "codeLensProvider": {"resolveProvider": True},
        "documentLinkProvider": {"resolveProvider": True},
        "colorProvider": True,
        "documentFormattingProvider": True,
        "documentRangeFormattingProvider": {"rangesSupport": True}
        if client.can("textDocument", "rangeFormatting", "rangesSupport")
        else True,
        "documentOnTypeFormattingProvider": {"firstTriggerCharacter": ":"},
        "renameProvider": {"prepareProvider": True}
        if client.can("textDocument", "rename", "prepareSupport") or not client.has("textDocument", "rename")
        else True,
        "foldingRangeProvider": True,
        "selectionRangeProvider": True,
        "linkedEditingRangeProvider": True,
        "monikerProvider": True,
        "callHierarchyProvider": True,
        "typeHierarchyProvider": True,
        "semanticTokensProvider": {
            "legend": {"tokenTypes": list(TYPES), "tokenModifiers": list(MODIFIERS)},
            "full": {"delta": True},
            "range": True,
        },
        "inlayHintProvider": {"resolveProvider": True},
        "executeCommandProvider": {"commands": [SAMPLE, SIMULATE], "workDoneProgress": True},
        "diagnosticProvider": {
            "identifier": "scenic",
            "interFileDependencies": True,
            "workspaceDiagnostics": True,
            "workDoneProgress": True,
        },
        "workspace": {
            "workspaceFolders": {"supported": True, "changeNotifications": True},
            "fileOperations": {
                name: {"filters": _FILES} for name in ("willRename", "didRename", "didCreate", "didDelete")
            },
        },
    }


def registrations(client: Client) -> list[Json]:
    """What the client is asked to report, as far as it can be asked."""
    found = []
    if client.can("workspace", "didChangeWatchedFiles", "dynamicRegistration"):
        watchers = [{"globPattern": pattern} for pattern in WATCHED]
        found.append(
            {
                "id": "scenic-watched-files",
                "method": "workspace/didChangeWatchedFiles",
                "registerOptions": {"watchers": watchers},
            }
        )
    if client.can("workspace", "didChangeConfiguration", "dynamicRegistration"):
        found.append(
            {
                "id": "scenic-configuration",
                "method": "workspace/didChangeConfiguration",
                "registerOptions": {"section": "scenic"},
            }
        )
    return found
