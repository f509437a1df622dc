//! Requests that change a text: fixes, the formatter, renaming.

use std::collections::HashMap;

use g7_edit::spliced;
use g7_ide::fixes::Fixes;
use g7_ide::{File, Positions, across, references};
use g7_model::{Said, say};
use g7_rig::Source;
use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, DocumentFormattingParams,
    PrepareRenameResponse, RenameParams, TextDocumentPositionParams, TextEdit, Uri, WorkspaceEdit,
};

use super::beside;
use super::heads::Heads;
use super::open::{Open, diagnostic};
use super::places;

/// The fixes of the problems that touch a range.
pub(super) fn fixes(open: &Open, p: &CodeActionParams) -> Option<Vec<CodeActionOrCommand>> {
    let uri = &p.text_document.uri;
    let file = open.file(uri)?;
    let asked = places::bytes(file, p.range);
    let mut found = Vec::new();
    let known = Fixes::of(file);
    for problem in &file.problems {
        let at = file.source.range(problem.at);
        if at.start > asked.end || asked.start > at.end {
            continue;
        }
        // Here the change itself is asked for, so a gesture that is refused is left out.
        let drafts =
            known.fixes(problem).into_iter().filter_map(|fix| Some((fix.edit(file).ok()?, fix.title)));
        found.extend(drafts.map(|(draft, title)| {
            CodeActionOrCommand::CodeAction(CodeAction {
                title,
                kind: Some(CodeActionKind::QUICKFIX),
                diagnostics: Some(vec![diagnostic(file, uri, problem)]),
                edit: Some(edit(uri, places::edits(file, &draft.splices))),
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

/// The change of a name in all files of its project, and in the io files that wire their variables.
#[allow(clippy::mutable_key_type, reason = "the type of the protocol; an address is never changed")]
pub(super) fn rename(open: &Open, p: &RenameParams) -> Result<Option<WorkspaceEdit>, String> {
    let Some((file, byte)) = at(open, &p.text_document_position) else { return Ok(None) };
    let uri = &p.text_document_position.text_document.uri;
    let changes = renamed(open, uri, (file, byte), &p.new_name).map_err(|e| e.in_language(file.language))?;
    Ok(Some(WorkspaceEdit::new(changes.into_iter().collect())))
}

fn renamed(
    open: &Open,
    uri: &Uri,
    (file, byte): (&File, usize),
    to: &str,
) -> Result<Vec<(Uri, Vec<TextEdit>)>, Said> {
    let name = references::changeable(file, byte).map(|(_, name)| name).unwrap_or_default();
    let project = Heads::of(open, uri)?;
    let Some((declared, at)) = project.sources.first().and_then(|own| across::declared(own, byte)) else {
        return in_one(uri, file, byte, (&name, to));
    };
    let heads: Vec<&Source> = project.sources.iter().filter(|head| across::has(head, &declared)).collect();
    // Where only this file is concerned, its text may have errors elsewhere.
    if heads.len() < 2 && heads.iter().all(|head| head.files().count() == 1) {
        return in_one(uri, file, byte, (&name, to));
    }
    let renamed = across::rename(&heads, (&declared, &at), to)?;
    let mut all = Vec::new();
    for (path, splices) in &renamed.changes {
        let source = heads.iter().find_map(|head| across::file(head, path));
        let (Some(source), Some(uri)) = (source, project.address(path)) else { continue };
        all.push((uri, places::edits_of(&Positions::new(&source.text), &source.text, splices)));
    }
    for (head, after) in &renamed.heads {
        let Some(uri) = project.address(&head.name) else { continue };
        all.extend(beside::renamed(&uri, head, after, &name)?);
    }
    Ok(all)
}

/// The change of a name that no other file knows.
fn in_one(
    uri: &Uri,
    file: &File,
    byte: usize,
    (name, to): (&str, &str),
) -> Result<Vec<(Uri, Vec<TextEdit>)>, Said> {
    let splices = references::rename(file, byte, to)?;
    let text = spliced(file.text(), &splices).ok_or_else(|| say!("the change does not fit the text"))?;
    let after = Source::native(&file.source.name, text.into_bytes(), 0).linked_like(&file.source);
    let mut all = beside::renamed(uri, &file.source, &after, name)?;
    all.push((uri.clone(), places::edits(file, &splices)));
    Ok(all)
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
