"""The capabilities that the server offers, and those that it asks the client to report.

That a feature is offered follows from its handler; here stands what there is to say besides.
"""

from collections.abc import Mapping
from typing import Any, Final

from lsprotocol import types
from pygls.capabilities import get_capability

from scenic.ide.semantic_tokens import MODIFIERS, TYPES

__all__ = [
    "COMMANDS",
    "FIX_ALL",
    "ORGANIZE",
    "SAMPLE",
    "SHOW",
    "SIMULATE",
    "WATCHED",
    "options_for",
    "registrations",
]

FIX_ALL: Final = "source.fixAll.scenic"
"""The kind of the action that makes all repairs of a document, which editors can make when they save it."""

ORGANIZE: Final = types.CodeActionKind.SourceOrganizeImports
"""The kind of the action that puts the imports of a document in order."""

SHOW: Final = "scenic.show"
"""The command that shows one scene; its arguments are the document's address and maybe an object with options."""

SAMPLE: Final = "scenic.sample"
"""The command that shows several scenes, with the same arguments."""

SIMULATE: Final = "scenic.simulate"
"""The command that simulates a program, with the same arguments; it takes the program as it was saved."""

COMMANDS: Final = (SHOW, SAMPLE, SIMULATE)

WATCHED: Final = ("**/*.scenic", "**/*.sc", "**/*.py", "**/pyproject.toml")
"""The files whose changes on the disk matter."""


def options_for(client: types.ClientCapabilities) -> Mapping[str, Any]:
    """Return by method the options with which it is offered to a client."""
    files = _modules_and_folders()
    options: dict[str, Any] = {
        types.TEXT_DOCUMENT_DID_SAVE: types.SaveOptions(include_text=False),
        types.TEXT_DOCUMENT_COMPLETION: types.CompletionOptions(
            trigger_characters=[".", " ", ",", "(", '"', "'", "/"], resolve_provider=True
        ),
        types.TEXT_DOCUMENT_SIGNATURE_HELP: types.SignatureHelpOptions(
            trigger_characters=["(", ","], retrigger_characters=["=", ")"]
        ),
        types.TEXT_DOCUMENT_REFERENCES: types.ReferenceOptions(work_done_progress=True),
        types.WORKSPACE_SYMBOL: types.WorkspaceSymbolOptions(work_done_progress=True),
        types.TEXT_DOCUMENT_ON_TYPE_FORMATTING: types.DocumentOnTypeFormattingOptions(":"),
        types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL: types.SemanticTokensLegend(list(TYPES), list(MODIFIERS)),
        types.TEXT_DOCUMENT_DIAGNOSTIC: types.DiagnosticOptions(
            inter_file_dependencies=True,
            workspace_diagnostics=True,
            identifier="scenic",
            work_done_progress=True,
        ),
        types.WORKSPACE_WILL_RENAME_FILES: files,
        types.WORKSPACE_DID_RENAME_FILES: files,
        types.WORKSPACE_DID_CREATE_FILES: files,
        types.WORKSPACE_DID_DELETE_FILES: files,
    }
    actions = get_capability(client, "text_document.code_action")
    if actions is None or actions.code_action_literal_support is not None:
        kinds = [
            types.CodeActionKind.QuickFix,
            FIX_ALL,
            ORGANIZE,
            types.CodeActionKind.RefactorExtract,
            types.CodeActionKind.RefactorInline,
        ]
        options[types.TEXT_DOCUMENT_CODE_ACTION] = types.CodeActionOptions(kinds, resolve_provider=True)
    if get_capability(client, "text_document.range_formatting.ranges_support"):
        options[types.TEXT_DOCUMENT_RANGE_FORMATTING] = types.DocumentRangeFormattingOptions(
            ranges_support=True
        )
    return options


def _modules_and_folders() -> types.FileOperationRegistrationOptions:
    """Return the files and folders whose creation, renaming and deletion matter."""
    kinds = types.FileOperationPatternKind
    patterns = (
        types.FileOperationPattern("**/*.{scenic,sc,py}", matches=kinds.File),
        types.FileOperationPattern("**", matches=kinds.Folder),
    )
    return types.FileOperationRegistrationOptions(
        [types.FileOperationFilter(pattern, scheme="file") for pattern in patterns]
    )


def registrations(client: types.ClientCapabilities) -> list[types.Registration]:
    """The reports that the client is asked for, as far as it can be asked."""
    reports = []
    if get_capability(client, "workspace.did_change_watched_files.dynamic_registration"):
        watchers = types.DidChangeWatchedFilesRegistrationOptions(
            [types.FileSystemWatcher(pattern) for pattern in WATCHED]
        )
        method = types.WORKSPACE_DID_CHANGE_WATCHED_FILES
        reports.append(types.Registration("scenic-watched-files", method, watchers))
    if get_capability(client, "workspace.did_change_configuration.dynamic_registration"):
        section = types.DidChangeConfigurationRegistrationOptions("scenic")
        method = types.WORKSPACE_DID_CHANGE_CONFIGURATION
        reports.append(types.Registration("scenic-configuration", method, section))
    return reports
