// CodeMirror's own texts in the language of the page.
import { prefs } from '../lib/prefs.svelte';

const table: Record<string, [fr: string, pt: string]> = {
  Find: ['Rechercher', 'Procurar'],
  Replace: ['Remplacer par', 'Substituir por'],
  next: ['suivant', 'seguinte'],
  previous: ['précédent', 'anterior'],
  all: ['tout', 'tudo'],
  'match case': ['respecter la casse', 'maiúsculas e minúsculas'],
  regexp: ['expression régulière', 'expressão regular'],
  'by word': ['mots entiers', 'palavras inteiras'],
  replace: ['remplacer', 'substituir'],
  'replace all': ['tout remplacer', 'substituir tudo'],
  close: ['fermer', 'fechar'],
  'current match': ['résultat actuel', 'resultado atual'],
  'on line': ['à la ligne', 'na linha'],
  'replaced $ matches': ['$ remplacements', '$ substituições'],
  'replaced match on line $': ['remplacé à la ligne $', 'substituído na linha $'],
  'Go to line': ['Aller à la ligne', 'Ir para a linha'],
  go: ['aller', 'ir'],
  'Folded lines': ['Lignes repliées', 'Linhas recolhidas'],
  'Unfolded lines': ['Lignes dépliées', 'Linhas expandidas'],
  'folded code': ['texte replié', 'texto recolhido'],
  unfold: ['déplier', 'expandir'],
  'Fold line': ['Replier', 'Recolher'],
  'Unfold line': ['Déplier', 'Expandir'],
  to: ['à', 'a'],
  Completions: ['Propositions', 'Sugestões'],
  Diagnostics: ['Problèmes', 'Problemas'],
  'No diagnostics': ['Aucun problème', 'Sem problemas'],
  'Selection deleted': ['Sélection supprimée', 'Seleção apagada'],
};

export function phrases(): Record<string, string> {
  const { language } = prefs;
  if (language === 'en') return {};
  return Object.fromEntries(Object.entries(table).map(([word, [fr, pt]]) => [word, language === 'fr' ? fr : pt]));
}
