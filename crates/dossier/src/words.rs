//! The words of a dossier, in English, French and Portuguese.

use g7_model::words::Told;

pub(crate) const COMPANY: Told = ["company", "société", "empresa"];
pub(crate) const TITLE: Told = ["title", "titre", "título"];
pub(crate) const SHEET: Told = ["sheet", "feuille", "folha"];
pub(crate) const AUTHOR: Told = ["author", "auteur", "autor"];
pub(crate) const PART: Told = ["part", "partie", "parte"];
pub(crate) const REVISION: Told = ["revision", "révision", "revisão"];
pub(crate) const FILE: Told = ["file", "fichier", "ficheiro"];
pub(crate) const PROGRAM: Told = ["drawn by", "dessiné par", "desenhado por"];
pub(crate) const DATE: Told = ["date", "date", "data"];

pub(crate) const COVER: Told = ["cover", "couverture", "capa"];
pub(crate) const CONTENTS: Told = ["Contents", "Sommaire", "Índice"];
pub(crate) const PROFILE: Told = ["profile", "profil", "perfil"];
pub(crate) const IN_SHORT: Told = ["In short", "En bref", "Em resumo"];
pub(crate) const LEFT_OUT: Told = ["Left out", "Non inclus", "Não incluído"];

pub(crate) const CHARTS: Told = ["Charts", "Grafcets", "Grafcets"];
pub(crate) const SIGNALS: Told = ["Inputs and outputs", "Entrées et sorties", "Entradas e saídas"];
pub(crate) const VARIABLES: Told =
    ["Variables and constants", "Variables et constantes", "Variáveis e constantes"];
pub(crate) const REFERENCES: Told = ["Cross references", "Références croisées", "Referências cruzadas"];
pub(crate) const BODIES: Told = [
    "Actions, functions and processing",
    "Actions, fonctions et traitements",
    "Ações, funções e processamentos",
];
pub(crate) const PLANTS: Told = ["Plants", "Parties opératives", "Partes operativas"];
pub(crate) const TESTS: Told = ["Tests", "Essais", "Testes"];
pub(crate) const PROOFS: Told = ["Proofs", "Preuves", "Provas"];
pub(crate) const PROBLEMS: Told =
    ["Problems and warnings", "Problèmes et avertissements", "Problemas e avisos"];

pub(crate) const STEPS: Told = ["steps", "étapes", "etapas"];
pub(crate) const TRANSITIONS: Told = ["transitions", "transitions", "transições"];
pub(crate) const INPUTS: Told = ["inputs", "entrées", "entradas"];
pub(crate) const OUTPUTS: Told = ["outputs", "sorties", "saídas"];
pub(crate) const PASSED_FAILED: Told = ["passed / failed", "réussis / échoués", "passados / falhados"];
pub(crate) const VERDICTS: Told = [
    "proved / refuted / not decided",
    "prouvées / réfutées / non décidées",
    "provadas / refutadas / não decididas",
];
pub(crate) const ERRORS_WARNINGS: Told = ["errors / warnings", "erreurs / avertissements", "erros / avisos"];

pub(crate) const CHART: Told = ["Chart {}", "Grafcet {}", "Grafcet {}"];
pub(crate) const EXPANSION: Told = ["Expansion {}", "Expansion {}", "Expansão {}"];
pub(crate) const TASK: Told = ["Task {}", "Tâche {}", "Tarefa {}"];
pub(crate) const OF_CHART: Told =
    ["Steps and transitions of {}", "Étapes et transitions de {}", "Etapas e transições de {}"];
pub(crate) const SHEET_OF: Told = ["({} of {})", "({} sur {})", "({} de {})"];
pub(crate) const STEP: Told = ["step", "étape", "etapa"];
pub(crate) const TRANSITION: Told = ["transition", "transition", "transição"];
pub(crate) const ACTIONS: Told = ["actions", "actions", "ações"];
pub(crate) const RECEPTIVITY: Told = ["receptivity", "réceptivité", "recetividade"];
pub(crate) const CLEARING: Told = ["on clearing", "au franchissement", "na transposição"];
pub(crate) const PRIORITY: Told = ["priority", "priorité", "prioridade"];
pub(crate) const INITIAL: Told = ["initial", "initiale", "inicial"];
pub(crate) const MACRO: Told = ["macro-step = {}", "macro-étape = {}", "macro-etapa = {}"];
pub(crate) const ENCLOSING: Told = ["enclosing step", "étape encapsulante", "etapa encapsulante"];
pub(crate) const ENTRY: Told = ["entry step", "étape d’entrée", "etapa de entrada"];
pub(crate) const EXIT: Told = ["exit step", "étape de sortie", "etapa de saída"];
pub(crate) const LINKED: Told = ["activation link", "lien d’activation", "ligação de ativação"];
pub(crate) const REMARKS: Told = ["Remarks on the drawing", "Remarques sur le dessin", "Notas no desenho"];

pub(crate) const NAME: Told = ["name", "nom", "nome"];
pub(crate) const CLASS: Told = ["class", "classe", "classe"];
pub(crate) const TYPE: Told = ["type", "type", "tipo"];
pub(crate) const CHANNEL: Told = ["channel", "voie", "canal"];
pub(crate) const SAFE: Told = ["safe value", "valeur de repli", "valor seguro"];
pub(crate) const START: Told = ["initial value", "valeur initiale", "valor inicial"];
pub(crate) const COMMENT: Told = ["comment", "commentaire", "comentário"];
pub(crate) const OWNER: Told = ["belongs to", "appartient à", "pertence a"];
pub(crate) const INVERTED: Told = ["inverted", "inversée", "invertido"];
pub(crate) const RETAIN: Told = ["retain", "rémanente", "remanente"];
pub(crate) const INPUT: Told = ["input", "entrée", "entrada"];
pub(crate) const OUTPUT: Told = ["output", "sortie", "saída"];
pub(crate) const VAR: Told = ["variable", "variable", "variável"];
pub(crate) const CONST: Told = ["constant", "constante", "constante"];
pub(crate) const FILE_ITSELF: Told = ["the file", "le fichier", "o ficheiro"];
pub(crate) const TYPES: Told = ["Types", "Types", "Tipos"];
pub(crate) const INSTANCES: Told = ["Instances", "Instances", "Instâncias"];

pub(crate) const DECLARED: Told = ["declared", "déclaré", "declarado"];
pub(crate) const READ: Told = ["read by", "lu par", "lido por"];
pub(crate) const WRITTEN: Told = ["written by", "écrit par", "escrito por"];
pub(crate) const ACTION: Told = ["action", "action", "ação"];
pub(crate) const SECTION: Told = ["transition section", "section de transition", "secção de transição"];
pub(crate) const FUNCTION: Told = ["function", "fonction", "função"];
pub(crate) const BLOCK: Told = ["function block", "bloc fonctionnel", "bloco funcional"];
pub(crate) const STRUCTURE: Told = ["structure", "structure", "estrutura"];
pub(crate) const PLANT: Told = ["plant", "partie opérative", "parte operativa"];
pub(crate) const TEST: Told = ["test", "essai", "teste"];
pub(crate) const PROPERTY: Told = ["question", "question", "pergunta"];
pub(crate) const DECLARATION: Told = ["declaration", "déclaration", "declaração"];

pub(crate) const NONE: Told = ["none", "aucun", "nenhum"];
pub(crate) const NO_VIEW: Told = [
    "This plant has no picture.",
    "Cette partie opérative n’a pas d’image.",
    "Esta parte operativa não tem imagem.",
];
pub(crate) const VIEW_LOST: Told =
    ["The picture {} is not here: {}", "L’image {} manque : {}", "Falta a imagem {}: {}"];
pub(crate) const PICTURE_BAD: Told =
    ["it is no SVG with a size", "ce n’est pas un SVG avec une taille", "não é um SVG com tamanho"];

pub(crate) const PASSED: Told = ["passed", "réussi", "passou"];
pub(crate) const FAILED: Told = ["failed", "échoué", "falhou"];
pub(crate) const RESULT: Told = ["result", "résultat", "resultado"];
pub(crate) const TIME: Told = ["time", "temps", "tempo"];
pub(crate) const SCANS: Told = ["scans", "cycles", "ciclos"];
pub(crate) const PLACE: Told = ["place", "endroit", "local"];
pub(crate) const SITUATION: Told = ["situation: {}", "situation : {}", "situação: {}"];
pub(crate) const GOT: Told = ["values: {}", "valeurs : {}", "valores: {}"];
pub(crate) const AT: Told = ["{}, at {}", "{}, à {}", "{}, em {}"];
pub(crate) const STEADY: Told = ["Unchanged: {}", "Sans changement : {}", "Sem mudança: {}"];

pub(crate) const CLAIM: Told = ["question", "question", "pergunta"];
pub(crate) const VERDICT: Told = ["answer", "réponse", "resposta"];
pub(crate) const SHOWN: Told = ["shown by", "montré par", "mostrado por"];
pub(crate) const PROVED: Told = ["proved", "prouvé", "provado"];
pub(crate) const REFUTED: Told = ["refuted", "réfuté", "refutado"];
pub(crate) const OPEN: Told = ["not decided", "non décidé", "não decidido"];
pub(crate) const OWN: Told = ["Questions of the author", "Questions de l’auteur", "Perguntas do autor"];
pub(crate) const EVERY: Told = [
    "Questions asked of every chart",
    "Questions posées à tout grafcet",
    "Perguntas feitas a qualquer grafcet",
];
pub(crate) const ASSUMED: Told = ["Assumptions", "Hypothèses", "Hipóteses"];

pub(crate) const SEVERITY: Told = ["severity", "gravité", "gravidade"];
pub(crate) const CODE: Told = ["code", "code", "código"];
pub(crate) const MESSAGE: Told = ["problem", "problème", "problema"];
pub(crate) const ERROR: Told = ["error", "erreur", "erro"];
pub(crate) const WARNING: Told = ["warning", "avertissement", "aviso"];
pub(crate) const HELP: Told = ["way out: {}", "remède : {}", "solução: {}"];
pub(crate) const FINE: Told = ["No problems.", "Aucun problème.", "Sem problemas."];

pub(crate) const NOT_RUN: Told =
    ["Not run for this dossier.", "Non exécutés pour ce dossier.", "Não executados para este dossiê."];
pub(crate) const NOT_ASKED: Told =
    ["Not asked for this dossier.", "Non posées pour ce dossier.", "Não feitas para este dossiê."];
pub(crate) const IN_THE_WAY: Told = [
    "Errors stand in the way; see the list of problems.",
    "Des erreurs l’empêchent ; voir la liste des problèmes.",
    "Há erros que o impedem; ver a lista de problemas.",
];

/// A text with its places filled.
pub(crate) fn fill(template: &str, with: &[&str]) -> String {
    let mut parts = template.split("{}");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for (part, word) in parts.zip(with.iter().copied().chain(std::iter::repeat(""))) {
        text.push_str(word);
        text.push_str(part);
    }
    text
}
