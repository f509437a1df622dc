import type { Words } from '../i18n';

/** Names that nothing declares, and the form of actions. */
export const names = {
  'names.new': ['New names', 'Nouveaux noms', 'Nomes novos'],
  'names.declare': ['Declare', 'Déclarer', 'Declarar'],
  'names.declareAll': ['Declare all ({n})', 'Tout déclarer ({n})', 'Declarar tudo ({n})'],
  'names.allHint': ['Declare {names}, each as its use asks for', 'Déclarer {names}, chacun selon son usage', 'Declarar {names}, cada um segundo o seu uso'],
  'names.class': ['Class of {name}', 'Classe de {name}', 'Classe de {name}'],
  'names.type': ['Type of {name}', 'Type de {name}', 'Tipo de {name}'],
  'names.done': ['Declared: {names}', 'Déclarés : {names}', 'Declarados: {names}'],
  'names.hint': ['Ctrl+Enter: declare · ↓: class and type', 'Ctrl+Entrée : déclarer · ↓ : classe et type', 'Ctrl+Enter: declarar · ↓: classe e tipo'],
  'cmd.declare': ['Declare the new names', 'Déclarer les nouveaux noms', 'Declarar os nomes novos'],
  'action.qualifier': ['Qualifier', 'Qualificateur', 'Qualificador'],
  'action.none': ['without: continuous, or stored where there is :=', 'sans : continue, ou mémorisée s’il y a :=', 'sem: contínua, ou memorizada se houver :='],
  'action.time': ['Time', 'Durée', 'Duração'],
  'action.unit': ['Unit of the time', 'Unité de la durée', 'Unidade da duração'],
  'action.hint': ['Alt+↓: qualifier', 'Alt+↓ : qualificateur', 'Alt+↓: qualificador'],
  'field.enter': ['Enter', 'Entrée', 'Enter'],
  'field.meant': ['Write {text}', 'Écrire {text}', 'Escrever {text}'],
} as const satisfies Words;
