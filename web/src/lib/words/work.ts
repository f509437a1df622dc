import type { Words } from '../i18n';

export const work = {
  'work.title': ['Unsaved work', 'Travail non enregistré', 'Trabalho por guardar'],
  'work.about': [
    'Changes that were closed or undone without being saved are kept for 30 days. Restoring opens them as unsaved changes.',
    'Les modifications fermées ou annulées sans être enregistrées sont gardées 30 jours. « Restaurer » les ouvre comme modifications non enregistrées.',
    'As alterações fechadas ou desfeitas sem serem guardadas ficam 30 dias. «Restaurar» abre-as como alterações por guardar.',
  ],
  'work.none': ['There is no unsaved work.', "Il n'y a pas de travail non enregistré.", 'Não há trabalho por guardar.'],
  'work.restore': ['Restore', 'Restaurer', 'Restaurar'],
  'work.delete': ['Delete', 'Supprimer', 'Eliminar'],
  'work.sure': ['Delete for good?', 'Supprimer définitivement ?', 'Eliminar definitivamente?'],
  'work.this': ['in this window', 'dans cette fenêtre', 'nesta janela'],
  'work.other': ['open in another window', 'ouvert dans une autre fenêtre', 'aberto noutra janela'],
  'work.gone': ['of a window that has gone', "d'une fenêtre disparue", 'de uma janela que já não existe'],
  'work.closed': ['closed', 'fermé', 'fechado'],
  'work.of': ['open with {person}', 'ouvert chez {person}', 'aberto por {person}'],
  'work.size': ['{n} characters', '{n} caractères', '{n} caracteres'],
  'work.away': ['This unsaved work is not there any more.', "Ce travail non enregistré n'existe plus.", 'Este trabalho por guardar já não existe.'],
  'work.elsewhere': [
    '{name} is open in another window, with changes that are not saved.',
    '{name} est ouvert dans une autre fenêtre, avec des modifications non enregistrées.',
    '{name} está aberto noutra janela, com alterações por guardar.',
  ],
  'work.with': [
    '{person} has changes of {name} that are not saved.',
    '{person} a des modifications non enregistrées de {name}.',
    '{person} tem alterações por guardar de {name}.',
  ],
  'work.left': [
    'A window that has gone left unsaved changes of {name}.',
    'Une fenêtre disparue a laissé des modifications non enregistrées de {name}.',
    'Uma janela que já não existe deixou alterações por guardar de {name}.',
  ],
  'work.later': ['Keep for later', 'Garder pour plus tard', 'Deixar para depois'],
} as const satisfies Words;
