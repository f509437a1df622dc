//! The texts that the editor has open, and the problems that it is told.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use g7_edit::{Splice, spliced};
use g7_ide::{File, Positions};
use g7_model::{Problem, Said, Severity, say};
use lsp_types::{
    Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DidChangeTextDocumentParams,
    DidCloseTextDocumentParams, DidOpenTextDocumentParams, DidSaveTextDocumentParams, Location,
    NumberOrString, PublishDiagnosticsParams, TextDocumentContentChangeEvent, Uri,
};

use super::used::Why;
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
    /// True if it uses the file at a path.
    fn uses(&self, path: &Path) -> bool {
        self.file.as_ref().is_ok_and(|file| used::paths(file, &self.uri).iter().any(|used| used == path))
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
        self.lend(uri.as_str(), Why::Fresh);
        self.hand_on(&uri);
    }

    /// The editor has saved a text. Files that it uses may have changed on the disk as well.
    pub(super) fn saved(&mut self, told: &DidSaveTextDocumentParams) {
        self.lend(told.text_document.uri.as_str(), Why::Fresh);
    }

    /// Gives the file at an address the texts that it uses.
    fn lend(&mut self, address: &str, why: Why<'_>) {
        // It is taken out, so that the others can be looked at.
        let Some(mut text) = self.texts.remove(address) else { return };
        if let Ok(file) = &mut text.file {
            let before = file.version;
            let open = |path: &Path| Some(self.at(path)?.text().to_owned());
            used::lend(file, &text.uri, why, &open);
            if file.version != before {
                self.changed.insert(address.to_owned());
            }
        }
        self.texts.insert(address.to_owned(), text);
    }

    /// Gives the file at an address to all that use it: its text has changed, or it was opened or closed.
    fn hand_on(&mut self, uri: &Uri) {
        let Some(path) = places::path(uri) else { return };
        let heads = self.texts.iter().filter(|(_, t)| t.uses(&path)).map(|(address, _)| address.clone());
        for head in heads.collect::<Vec<_>>() {
            self.lend(&head, Why::Changed(&path));
        }
    }

    /// The open files, with their addresses.
    pub(super) fn all(&self) -> impl Iterator<Item = (&Uri, &File)> {
        self.texts.values().filter_map(|text| Some((&text.uri, text.file.as_ref().ok()?)))
    }

    /// The file at a path, if it is open.
    fn at(&self, path: &Path) -> Option<&File> {
        let text = self.texts.values().find(|t| places::path(&t.uri).as_deref() == Some(path))?;
        text.file.as_ref().ok()
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
        self.lend(uri.as_str(), Why::Typed);
        self.hand_on(&uri);
    }

    pub(super) fn end(&mut self, told: DidCloseTextDocumentParams) {
        let uri = told.text_document.uri;
        self.changed.remove(uri.as_str());
        if self.texts.remove(uri.as_str()).is_some() {
            // For those that use it, the text on the disk counts again.
            self.hand_on(&uri);
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
