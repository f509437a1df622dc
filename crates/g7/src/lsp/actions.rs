//! Requests that change a text: fixes, the formatter, renaming.

use std::collections::HashMap;

use g7_ide::{File, fixes, references};
use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, DocumentFormattingParams,
    PrepareRenameResponse, RenameParams, TextDocumentPositionParams, TextEdit, Uri, WorkspaceEdit,
};

use super::beside;
use super::open::{Open, diagnostic};
use super::places;

/// The fixes of the problems that touch a range.
pub(super) fn fixes(open: &Open, p: &CodeActionParams) -> Option<Vec<CodeActionOrCommand>> {
    let uri = &p.text_document.uri;
    let file = open.file(uri)?;
    let asked = places::bytes(file, p.range);
    let mut found = Vec::new();
    for problem in &file.problems {
        let at = file.source.range(problem.at);
        if at.start > asked.end || asked.start > at.end {
            continue;
        }
        found.extend(fixes::fixes(file, problem, true).into_iter().map(|fix| {
            CodeActionOrCommand::CodeAction(CodeAction {
                title: fix.title,
                kind: Some(CodeActionKind::QUICKFIX),
                diagnostics: Some(vec![diagnostic(file, uri, problem)]),
                edit: Some(edit(uri, places::edits(file, &fix.splices))),
                ..CodeAction::default()
            })
        }));
    }
    Some(found)
}

/// The change that formats a text; none if it has syntax errors.
pub(super) fn format(open: &Open, p: &DocumentFormattingParams) -> Option<Vec<TextEdit>> {
    let file = open.file(&p.text_document.uri)?;
    Some(places::edits(file, &g7_ide::format(file)?))
}

/// The name at a place, if it can be changed.
pub(super) fn changeable(open: &Open, p: &TextDocumentPositionParams) -> Option<PrepareRenameResponse> {
    let (file, byte) = at(open, p)?;
    let (range, placeholder) = references::changeable(file, byte)?;
    Some(PrepareRenameResponse::RangeWithPlaceholder { range: places::range(file, &range), placeholder })
}

/// The change of a name in its file, and in the io files that wire the variables of that file.
#[allow(clippy::mutable_key_type, reason = "the type of the protocol; an address is never changed")]
pub(super) fn rename(open: &Open, p: &RenameParams) -> Result<Option<WorkspaceEdit>, String> {
    let Some((file, byte)) = at(open, &p.text_document_position) else { return Ok(None) };
    let uri = &p.text_document_position.text_document.uri;
    let splices = references::rename(file, byte, &p.new_name).map_err(|e| e.in_language(file.language))?;
    let name = references::changeable(file, byte).map(|(_, name)| name).unwrap_or_default();
    let mut changes: HashMap<Uri, Vec<TextEdit>> = beside::renamed(uri, file, &name, &splices)
        .map_err(|e| e.in_language(file.language))?
        .into_iter()
        .collect();
    changes.insert(uri.clone(), places::edits(file, &splices));
    Ok(Some(WorkspaceEdit::new(changes)))
}

/// The file and the byte at a place.
pub(super) fn at<'o>(open: &'o Open, p: &TextDocumentPositionParams) -> Option<(&'o File, usize)> {
    let file = open.file(&p.text_document.uri)?;
    Some((file, places::byte(&file.positions, file.text(), p.position)))
}

#[allow(clippy::mutable_key_type, reason = "the type of the protocol; an address is never changed")]
fn edit(uri: &Uri, edits: Vec<TextEdit>) -> WorkspaceEdit {
    WorkspaceEdit::new(HashMap::from([(uri.clone(), edits)]))
}
