import type { Words } from '../i18n';

export const text = {
  'text.of': ['Text of {name}', 'Texte de {name}', 'Texto de {name}'],
  'text.place': ['Line {line}, column {column}', 'Ligne {line}, colonne {column}', 'Linha {line}, coluna {column}'],
  'text.hint': ['F2 rename · F8 next problem · Ctrl+. fix · F12 declaration · Shift+F12 uses · Esc, Tab: leave', 'F2 renommer · F8 problème suivant · Ctrl+. corriger · F12 déclaration · Maj+F12 emplois · Échap, Tab : sortir', 'F2 mudar o nome · F8 problema seguinte · Ctrl+. corrigir · F12 declaração · Shift+F12 usos · Esc, Tab: sair'],
  'text.goto': ['Go to …', 'Aller à …', 'Ir para …'],
  'text.format': ['Format', 'Mettre en forme', 'Formatar'],
  'text.plants': ['Plants', 'Parties opératives', 'Processos'],
  'text.tests': ['Tests', 'Essais', 'Testes'],
  'text.noName': ['There is no name of this file at the cursor.', "Pas de nom de ce fichier sous le curseur.", 'Não há nenhum nome deste ficheiro no cursor.'],
  'text.noRename': ['{name} is not declared in this file: it keeps its name.', "{name} n'est pas déclaré dans ce fichier : il garde son nom.", '{name} não é declarado neste ficheiro: mantém o nome.'],
  'text.why': ['Explain', 'Expliquer', 'Explicar'],
  'text.rename': ['Rename ({n})', 'Renommer ({n})', 'Mudar o nome ({n})'],
  'text.renameTo': ['New name of {name}, in {n} places', 'Nouveau nom de {name}, à {n} endroits', 'Novo nome de {name}, em {n} sítios'],
  'text.places': ['{name}: {n} places', '{name} : {n} endroits', '{name}: {n} sítios'],
  'text.sign.bar': ['not: a̅, overline', 'non : a̅, barre', 'não: a̅, barra'],
  'text.sign.to': ['arrow of a transition', "flèche d'une transition", 'seta de uma transição'],
  'text.sign.ne': ['not equal', 'différent', 'diferente'],
  'text.sign.le': ['at most', 'au plus', 'no máximo'],
  'text.sign.ge': ['at least', 'au moins', 'no mínimo'],
} as const satisfies Words;
