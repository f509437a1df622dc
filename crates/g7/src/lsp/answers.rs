//! Requests that only ask: each is converted, asked of `ide`, and its answer converted back.

use g7_ide::completion::complete;
use g7_ide::lenses::Work;
use g7_ide::outline::{Entry, Kind};
use g7_ide::tokens::{Class, Coloured};
use g7_ide::{File, Positions, references};
use lsp_types::{
    CodeLens, CodeLensParams, Command, CompletionItem, CompletionItemKind, CompletionParams,
    CompletionTextEdit, DocumentHighlight, DocumentHighlightParams, DocumentSymbol, DocumentSymbolParams,
    FoldingRange, FoldingRangeParams, GotoDefinitionParams, Hover, HoverContents, HoverParams, Location,
    MarkupContent, MarkupKind, Range, ReferenceParams, SemanticToken, SemanticTokens, SemanticTokensParams,
    SemanticTokensRangeParams, SymbolKind, TextEdit,
};
use serde_json::{Value, json};

use super::actions::at;
use super::open::Open;
use super::places;

/// The abilities of the server.
pub(super) fn capabilities() -> Value {
    json!({
        "positionEncoding": "utf-16",
        "textDocumentSync": { "openClose": true, "change": 2, "save": true },
        "completionProvider": { "triggerCharacters": [".", ">", ":"] },
        "hoverProvider": true,
        "definitionProvider": true,
        "referencesProvider": true,
        "documentHighlightProvider": true,
        "documentSymbolProvider": true,
        "foldingRangeProvider": true,
        "documentFormattingProvider": true,
        "renameProvider": { "prepareProvider": true },
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        "codeLensProvider": {},
        "inlayHintProvider": true,
        "executeCommandProvider": { "commands": [super::shows::FOLLOW] },
        "semanticTokensProvider": {
            "legend": { "tokenTypes": Class::ALL.map(kind), "tokenModifiers": [] },
            "full": true,
            "range": true,
        },
    })
}

/// The name of the protocol for a class of tokens, so that every theme has a colour for it.
fn kind(class: Class) -> &'static str {
    match class {
        Class::Keyword => "keyword",
        Class::Type => "type",
        Class::Chart => "class",
        Class::Variable => "variable",
        Class::Step => "enumMember",
        Class::Function => "function",
        Class::Name => "variable",
        Class::Number | Class::Time => "number",
        Class::String | Class::Comment => "string",
        Class::Note => "comment",
        Class::Direct => "macro",
        Class::Bracket | Class::Punctuation | Class::Operator => "operator",
    }
}

pub(super) fn completion(open: &Open, p: &CompletionParams) -> Option<Vec<CompletionItem>> {
    let (file, byte) = at(open, &p.text_document_position)?;
    let found = complete(file, byte);
    let range = places::range(file, &(found.from..byte));
    let item = |(n, c): (usize, g7_ide::completion::Choice)| CompletionItem {
        kind: Some(match c.kind {
            "keyword" | "profile" => CompletionItemKind::KEYWORD,
            "variable" => CompletionItemKind::VARIABLE,
            "step" => CompletionItemKind::ENUM_MEMBER,
            "chart" | "plant" => CompletionItemKind::CLASS,
            "function" => CompletionItemKind::FUNCTION,
            "type" => CompletionItemKind::TYPE_PARAMETER,
            "member" => CompletionItemKind::FIELD,
            _ => CompletionItemKind::TEXT,
        }),
        detail: Some(c.detail.in_language(file.language)).filter(|d| !d.is_empty()),
        text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(range, c.insert))),
        // The likely words stand first, as they came.
        sort_text: Some(format!("{n:04}")),
        filter_text: Some(c.label.clone()),
        label: c.label,
        ..CompletionItem::default()
    };
    Some(found.items.into_iter().enumerate().map(item).collect())
}

pub(super) fn hover(open: &Open, p: &HoverParams) -> Option<Hover> {
    let (file, byte) = at(open, &p.text_document_position_params)?;
    let found = g7_ide::hover::hover(file, byte)?;
    let mut told = found.markdown;
    if let Some(source) = found.source {
        told += &format!("\n\nRule: {source}.");
    }
    if let Some(case) = found.case.and_then(g7_ide::cases::find) {
        let g7_ide::cases::Case { title, rule, source, chart } = case;
        told += &format!("\n\n---\n\n**{title}.** {rule}\n\n```g7\n{chart}\n```\n\n{source}");
    }
    let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value: told });
    Some(Hover { contents, range: Some(places::range(file, &found.range)) })
}

pub(super) fn definition(open: &Open, p: &GotoDefinitionParams) -> Option<Location> {
    let p = &p.text_document_position_params;
    let (file, byte) = at(open, p)?;
    let found = references::uses(file, byte);
    if let Some(there) = found.elsewhere {
        let home = file.source.home(there);
        // The parts of the library are texts in the program: there is no file to open.
        let other = file.source.others().iter().find(|o| !o.library && o.source.name == home.name)?;
        let uri = places::beside(&p.text_document.uri, &other.path)?;
        return Some(Location::new(
            uri,
            places::range_of(&Positions::new(&home.text), &home.text, &there.bytes()),
        ));
    }
    Some(Location::new(p.text_document.uri.clone(), places::range(file, &found.declared?)))
}

pub(super) fn references(open: &Open, p: &ReferenceParams) -> Option<Vec<Location>> {
    let (file, byte) = at(open, &p.text_document_position)?;
    let mut found = references::uses(file, byte);
    if !p.context.include_declaration {
        found.all.retain(|r| found.declared.as_ref() != Some(r));
    }
    let uri = &p.text_document_position.text_document.uri;
    Some(found.all.iter().map(|r| Location::new(uri.clone(), places::range(file, r))).collect())
}

pub(super) fn highlights(open: &Open, p: &DocumentHighlightParams) -> Option<Vec<DocumentHighlight>> {
    let (file, byte) = at(open, &p.text_document_position_params)?;
    let mark = |r| DocumentHighlight { range: places::range(file, r), kind: None };
    Some(references::uses(file, byte).all.iter().map(mark).collect())
}

pub(super) fn outline(open: &Open, p: &DocumentSymbolParams) -> Option<Vec<DocumentSymbol>> {
    let file = open.file(&p.text_document.uri)?;
    // Places of an earlier text would be wrong ones.
    let readable = Some(file.drawn()).filter(|r| !r.stale)?;
    Some(g7_ide::outline::outline(&readable).into_iter().map(|e| symbol(file, e)).collect())
}

fn symbol(file: &File, e: Entry) -> DocumentSymbol {
    let inside: Vec<DocumentSymbol> = e.inside.into_iter().map(|e| symbol(file, e)).collect();
    #[allow(deprecated, reason = "the protocol's struct still has the field `deprecated`")]
    DocumentSymbol {
        // The protocol forbids an empty name.
        name: if e.name.is_empty() { "…".to_owned() } else { e.name },
        detail: Some(e.detail.in_language(file.language)).filter(|d| !d.is_empty()),
        kind: match e.kind {
            Kind::Chart => SymbolKind::CLASS,
            Kind::Step => SymbolKind::ENUM_MEMBER,
            Kind::Transition => SymbolKind::EVENT,
            Kind::Variable => SymbolKind::VARIABLE,
            Kind::Function => SymbolKind::FUNCTION,
            Kind::Plant => SymbolKind::MODULE,
            Kind::Test => SymbolKind::METHOD,
        },
        tags: None,
        deprecated: None,
        range: places::range(file, &e.range),
        selection_range: places::range(file, &e.named),
        children: Some(inside).filter(|c| !c.is_empty()),
    }
}

pub(super) fn folds(open: &Open, p: &FoldingRangeParams) -> Option<Vec<FoldingRange>> {
    let file = open.file(&p.text_document.uri)?;
    let fold = |bytes: std::ops::Range<usize>| {
        let Range { start, end } = places::range(file, &bytes);
        FoldingRange { start_line: start.line, end_line: end.line, ..FoldingRange::default() }
    };
    Some(g7_ide::outline::folds(file.text()).into_iter().map(fold).collect())
}

pub(super) fn tokens(open: &Open, p: &SemanticTokensParams) -> Option<SemanticTokens> {
    let file = open.file(&p.text_document.uri)?;
    Some(coloured(file, 0..file.text().len()))
}

pub(super) fn tokens_between(open: &Open, p: &SemanticTokensRangeParams) -> Option<SemanticTokens> {
    let file = open.file(&p.text_document.uri)?;
    Some(coloured(file, places::bytes(file, p.range)))
}

/// Tokens in the five numbers of the protocol, relative to the token before; one of several lines
/// becomes one for each line, because many clients know no others.
fn coloured(file: &File, bytes: std::ops::Range<usize>) -> SemanticTokens {
    let text = file.text();
    let (mut line, mut start) = (0, 0);
    let mut data = Vec::new();
    for Coloured { range, class } in g7_ide::tokens::tokens(file, bytes) {
        let mut from = range.start;
        for part in text.get(range).unwrap_or("").split_inclusive('\n') {
            let place = places::range(file, &(from..from + part.trim_end_matches(['\r', '\n']).len()));
            from += part.len();
            let length = place.end.character - place.start.character;
            if length == 0 {
                continue;
            }
            let delta_line = place.start.line - line;
            let delta_start = place.start.character - if delta_line == 0 { start } else { 0 };
            (line, start) = (place.start.line, place.start.character);
            let token_type = Class::ALL.iter().position(|c| *c == class).unwrap_or(0) as u32;
            data.push(SemanticToken {
                delta_line,
                delta_start,
                length,
                token_type,
                token_modifiers_bitset: 0,
            });
        }
    }
    SemanticTokens { result_id: None, data }
}

/// The offers above charts, tests and properties; the editor's extension carries out their commands.
pub(super) fn lenses(open: &Open, p: &CodeLensParams) -> Option<Vec<CodeLens>> {
    let uri = &p.text_document.uri;
    let file = open.file(uri)?;
    let readable = Some(file.drawn()).filter(|r| !r.stale)?;
    let lens = |l: g7_ide::lenses::Lens| {
        let (title, command, name) = match l.work {
            Work::Run => ("run", "g7.run", String::new()),
            Work::Draw(chart) => ("draw", "g7.draw", chart),
            Work::Test(title) => ("test", "g7.test", title),
            Work::Prove => ("prove", "g7.prove", String::new()),
        };
        let start = places::range(file, &file.source.range(l.at)).start;
        let arguments = Some(vec![json!(uri.as_str()), json!(name)]);
        CodeLens {
            range: Range::new(start, start),
            command: Some(Command { title: title.to_owned(), command: command.to_owned(), arguments }),
            data: None,
        }
    };
    Some(g7_ide::lenses::lenses(&readable).into_iter().map(lens).collect())
}
