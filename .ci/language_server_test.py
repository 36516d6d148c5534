"""Drives `eng lsp` with pytest-lsp, a client of another author. Usage: ENG=COMMAND pytest .ci/language_server_test.py

The client announces the capabilities of Visual Studio Code and of Neovim in turn. It reads each answer by the types of the protocol's
own description, and its warning about an answer that the announced capabilities do not allow is an error here. The tests of
`tests/language_server.rs` test the contents of the answers. These test that a client of another author reads them.
"""

import asyncio
import os
import pathlib
import re

import pytest
import pytest_lsp
from lsprotocol import types
from pytest_lsp import ClientServerConfig, LanguageClient, LspSpecificationWarning

pytestmark = [
    pytest.mark.asyncio,
    pytest.mark.filterwarnings(f"error::{LspSpecificationWarning.__module__}.{LspSpecificationWarning.__name__}"),
]

MODEL = pathlib.Path(__file__).parent.parent / "examples" / "swing" / "swing.eng"
TEXT = MODEL.read_text()
URI = MODEL.as_uri()
# seconds until a message or an answer must have come: a guard against a hang, not a demand on speed
PATIENCE = 300


@pytest_lsp.fixture(
    config=ClientServerConfig(server_command=[os.environ["ENG"], "lsp", "--stdio"]), params=["visual-studio-code", "neovim"]
)
async def client(request: pytest.FixtureRequest, lsp_client: LanguageClient):
    """A session, from `initialize` to the end of the process."""
    folder = types.WorkspaceFolder(uri=MODEL.parent.as_uri(), name="swing")
    capabilities = pytest_lsp.client_capabilities(request.param)
    params = types.InitializeParams(capabilities=capabilities, workspace_folders=[folder])
    answer = await asyncio.wait_for(lsp_client.initialize_session(params), PATIENCE)
    assert answer.server_info is not None and answer.server_info.name == "eng"
    yield
    await asyncio.wait_for(lsp_client.shutdown_session(), PATIENCE)
    assert lsp_client._server.returncode == 0


def place(text: str, mark: str, after: int = 0) -> types.Position:
    """The place some characters after the beginning of the first mark in a text of ASCII letters."""
    before = text[: text.index(mark) + after]
    return types.Position(line=before.count("\n"), character=len(before) - before.rfind("\n") - 1)


def at(text: str, mark: str, after: int = 0) -> dict[str, object]:
    return {"text_document": types.TextDocumentIdentifier(uri=URI), "position": place(text, mark, after)}


def edited(text: str, edits: list[types.TextEdit]) -> str:
    """A text of ASCII letters after edits."""
    starts = [0] + [match.end() for match in re.finditer("\n", text)]

    def byte(position: types.Position) -> int:
        return min(starts[position.line] + position.character, len(text)) if position.line < len(starts) else len(text)

    for edit in sorted(edits, key=lambda edit: byte(edit.range.start), reverse=True):
        text = text[: byte(edit.range.start)] + edit.new_text + text[byte(edit.range.end) :]
    return text


async def messages(client: LanguageClient) -> list[types.Diagnostic]:
    await asyncio.wait_for(client.wait_for_notification(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS), PATIENCE)
    return list(client.diagnostics[URI])


async def opened(client: LanguageClient, text: str) -> list[types.Diagnostic]:
    """The first messages about a text."""
    document = types.TextDocumentItem(uri=URI, language_id="eng", version=1, text=text)
    client.text_document_did_open(types.DidOpenTextDocumentParams(text_document=document))
    return await messages(client)


async def test_messages_follow_the_text(client: LanguageClient):
    [message] = await opened(client, TEXT.replace("= 2 m\n", "= 2 mn\n"))
    assert message.severity == types.DiagnosticSeverity.Error and message.source == "eng"
    assert message.range.start == place(TEXT, "2 m\n", 2)
    asked = types.CodeActionParams(
        text_document=types.TextDocumentIdentifier(uri=URI),
        range=message.range,
        context=types.CodeActionContext(diagnostics=[message]),
    )
    actions = await client.text_document_code_action_async(asked)
    assert any(isinstance(action, types.CodeAction) and action.edit.changes[URI] for action in actions)

    document = types.VersionedTextDocumentIdentifier(uri=URI, version=2)
    change = types.TextDocumentContentChangePartial(range=message.range, text="m")
    client.text_document_did_change(types.DidChangeTextDocumentParams(text_document=document, content_changes=[change]))
    assert await messages(client) == []


async def test_words_that_come_next(client: LanguageClient):
    text = TEXT.replace("norm(hinge.force)", "norm(hinge.)")
    assert await opened(client, text)
    found = await client.text_document_completion_async(types.CompletionParams(**at(text, "norm(hinge.", 11)))
    items = found.items if isinstance(found, types.CompletionList) else found
    assert {"force", "torque", "angle"} <= {item.label for item in items}
    assert "mass" not in {item.label for item in items}


async def test_hover_shows_the_comment(client: LanguageClient):
    assert await opened(client, TEXT) == []
    hover = await client.text_document_hover_async(types.HoverParams(**at(TEXT, "angle = begin", 9)))
    assert isinstance(hover.contents, types.MarkupContent)
    assert "Angle from the vertical at which it is let go" in hover.contents.value


async def test_definitions_lead_to_the_text_and_to_the_library(client: LanguageClient):
    assert await opened(client, TEXT) == []
    own = await client.text_document_definition_async(types.DefinitionParams(**at(TEXT, "1, 0]*length", 7)))
    assert own.uri == URI and own.range.start.line == place(TEXT, "param length").line
    library = await client.text_document_definition_async(types.DefinitionParams(**at(TEXT, "Revolute(")))
    assert library.uri.endswith("/std/joints.eng")


async def test_another_name_takes_all_its_places(client: LanguageClient):
    assert await opened(client, TEXT) == []
    change = await client.text_document_rename_async(types.RenameParams(**at(TEXT, "length: Length"), new_name="rods"))
    if change.changes is not None:
        edits = {uri: list(found) for uri, found in change.changes.items()}
    else:
        edits = {found.text_document.uri: list(found.edits) for found in change.document_changes}
    assert set(edits) == {URI}
    assert edited(TEXT, edits[URI]) == re.sub(r"\blength\b", "rods", TEXT)


async def test_form_and_outline(client: LanguageClient):
    text = TEXT.replace("    param length: Length = 2 m", "  param length : Length=2 m")
    assert await opened(client, text) == []
    options = types.FormattingOptions(tab_size=4, insert_spaces=True)
    document = types.TextDocumentIdentifier(uri=URI)
    asked = types.DocumentFormattingParams(text_document=document, options=options)
    assert edited(text, list(await client.text_document_formatting_async(asked))) == TEXT
    outline = await client.text_document_document_symbol_async(types.DocumentSymbolParams(text_document=document))
    assert [symbol.name for symbol in outline] == ["Swing", "release", "swing"]


async def test_colours_types_and_the_command_run(client: LanguageClient):
    text = TEXT.replace("    joint hinge", "    output rise = length\n    joint hinge")
    assert await opened(client, text) == []
    document = types.TextDocumentIdentifier(uri=URI)
    tokens = await client.text_document_semantic_tokens_full_async(types.SemanticTokensParams(text_document=document))
    assert tokens.data and len(tokens.data) % 5 == 0
    lenses = await client.text_document_code_lens_async(types.CodeLensParams(text_document=document))
    assert [(lens.command.command, *lens.command.arguments) for lens in lenses] == [("eng.run", URI, "release")]
    whole = types.Range(start=types.Position(0, 0), end=types.Position(text.count("\n"), 0))
    hints = await client.text_document_inlay_hint_async(types.InlayHintParams(text_document=document, range=whole))
    assert [(hint.position, hint.label) for hint in hints] == [(place(text, " = length"), ": Length")]
