//! The texts that the editor has open, and the problems that it is told.

use std::collections::{BTreeMap, BTreeSet};

use g7_edit::{Splice, spliced};
use g7_ide::{File, Positions};
use g7_model::{Problem, Said, Severity, say};
use lsp_types::{
    Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DidChangeTextDocumentParams,
    DidCloseTextDocumentParams, DidOpenTextDocumentParams, Location, NumberOrString,
    PublishDiagnosticsParams, TextDocumentContentChangeEvent, Uri,
};

use super::{places, used};

/// The open texts, by address.
#[derive(Default)]
pub(super) struct Open {
    /// The language of the reader.
    pub(super) language: g7_model::Language,
    texts: BTreeMap<String, Text>,
    /// Those whose problems are not told yet.
    changed: BTreeSet<String>,
    /// Those that were closed: their problems are taken back.
    closed: Vec<Uri>,
}

/// An open text.
struct Text {
    uri: Uri,
    version: i32,
    /// The file; the reason if G7 cannot take it.
    file: Result<File, Said>,
}

impl Text {
    /// The addresses of the files that it uses.
    fn uses(&self) -> impl Iterator<Item = Uri> {
        let names = self.file.as_ref().map_or(&[][..], |f| &f.uses);
        names.iter().filter_map(|name| used::beside(&self.uri, name))
    }
}

impl Open {
    /// No texts, for a reader of this language.
    pub(super) fn in_language(language: g7_model::Language) -> Open {
        Open { language, ..Open::default() }
    }

    /// The file at an address, if it is open.
    pub(super) fn file(&self, uri: &Uri) -> Option<&File> {
        self.texts.get(uri.as_str())?.file.as_ref().ok()
    }

    pub(super) fn begin(&mut self, told: DidOpenTextDocumentParams) {
        let document = told.text_document;
        let uri = document.uri;
        let mut file = File::open_native(&name(&uri), document.text);
        if let Ok(file) = &mut file {
            file.language = self.language;
        }
        self.changed.insert(uri.as_str().to_owned());
        self.texts
            .insert(uri.as_str().to_owned(), Text { uri: uri.clone(), version: document.version, file });
        self.lend(&uri);
    }

    /// Lends files the texts that they use: the one at an address, and all that may use that.
    fn lend(&mut self, about: &Uri) {
        let heads = self.texts.values().filter(|t| t.uri == *about || t.uses().any(|u| u == *about));
        let heads: Vec<String> = heads.map(|t| t.uri.as_str().to_owned()).collect();
        for address in heads {
            // While a file is lent to, the others can be looked at.
            let Some(mut text) = self.texts.remove(&address) else { continue };
            if let Ok(file) = &mut text.file {
                let before = file.version;
                let open = |uri: &Uri| Some(self.file(uri)?.text().to_owned());
                used::lend(file, &text.uri, &open);
                if file.version != before {
                    self.changed.insert(address.clone());
                }
            }
            self.texts.insert(address, text);
        }
    }

    pub(super) fn change(&mut self, told: DidChangeTextDocumentParams) {
        let uri = told.text_document.uri;
        let Some(text) = self.texts.get_mut(uri.as_str()) else { return };
        text.version = told.text_document.version;
        let Ok(file) = &mut text.file else { return };
        if let Err(no) = changed(file, told.content_changes).and_then(|new| file.take(new)) {
            text.file = Err(no);
        }
        self.changed.insert(uri.as_str().to_owned());
        self.lend(&uri);
    }

    pub(super) fn end(&mut self, told: DidCloseTextDocumentParams) {
        let uri = told.text_document.uri;
        self.changed.remove(uri.as_str());
        if self.texts.remove(uri.as_str()).is_some() {
            // Those that use it see what is on the disk again.
            self.lend(&uri);
            self.closed.push(uri);
        }
    }

    /// The problems to be told: those of texts that changed since this was asked last.
    pub(super) fn problems(&mut self) -> Vec<PublishDiagnosticsParams> {
        let gone = std::mem::take(&mut self.closed);
        let mut told: Vec<PublishDiagnosticsParams> =
            gone.into_iter().map(|uri| PublishDiagnosticsParams::new(uri, Vec::new(), None)).collect();
        for address in std::mem::take(&mut self.changed) {
            let Some(text) = self.texts.get(&address) else { continue };
            let problems = match &text.file {
                Ok(file) => file.problems.iter().map(|p| diagnostic(file, &text.uri, p)).collect(),
                Err(no) => {
                    vec![Diagnostic {
                        message: no.in_language(self.language),
                        source: source(),
                        ..Diagnostic::default()
                    }]
                }
            };
            told.push(PublishDiagnosticsParams::new(text.uri.clone(), problems, Some(text.version)));
        }
        told
    }
}

/// The text after changes, each of which follows the one before.
fn changed(file: &File, changes: Vec<TextDocumentContentChangeEvent>) -> Result<String, Said> {
    let mut text = file.text().to_owned();
    for change in changes {
        let Some(range) = change.range else {
            text = change.text;
            continue;
        };
        let positions = Positions::new(&text);
        let start = places::byte(&positions, &text, range.start);
        let end = places::byte(&positions, &text, range.end).max(start);
        text = spliced(&text, &[Splice::new(start, end, change.text)])
            .ok_or_else(|| say!("a change does not fit the text; close the file and open it again"))?;
    }
    Ok(text)
}

/// The last part of an address, for messages.
fn name(uri: &Uri) -> String {
    uri.as_str().rsplit('/').next().unwrap_or("chart.g7").to_owned()
}

fn source() -> Option<String> {
    Some("g7".to_owned())
}

/// A problem as the protocol has it; the help stands on a line of its own.
pub(super) fn diagnostic(file: &File, uri: &Uri, p: &Problem) -> Diagnostic {
    let place = |at| places::range(file, &file.source.range(at));
    let related = p.related.iter().map(|(at, what)| DiagnosticRelatedInformation {
        location: Location::new(uri.clone(), place(*at)),
        message: what.in_language(file.language),
    });
    let help = p.help.as_ref().map_or(String::new(), |h| format!("\n{}", h.in_language(file.language)));
    Diagnostic {
        range: place(p.at),
        severity: Some(match p.severity() {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
        }),
        code: Some(NumberOrString::String(p.code.id.to_owned())),
        source: source(),
        message: format!("{}{help}", p.what.in_language(file.language)),
        related_information: Some(related.collect::<Vec<_>>()).filter(|r| !r.is_empty()),
        ..Diagnostic::default()
    }
}
