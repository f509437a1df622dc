import type { Words } from '../i18n';

export const together = {
  'tog.title': ['Work together', 'Travailler à plusieurs', 'Trabalhar em conjunto'],
  'tog.about': [
    'Everyone who joins has this file open as one text: what one changes, all see at once, and everyone sees where the others are. Until then each person has a copy of their own.',
    "Tous ceux qui se joignent ont ce fichier ouvert comme un seul texte : ce que l'un modifie, tous le voient aussitôt, et chacun voit où sont les autres. Jusque-là, chacun a sa propre copie.",
    'Todos os que se juntam têm este ficheiro aberto como um só texto: o que um altera, todos veem de imediato, e cada um vê onde estão os outros. Até lá, cada pessoa tem uma cópia sua.',
  ],
  'tog.aboutLook': [
    'You look: you see what the others change, and where they are. To change the chart yourself, stop looking; your copy is your own then.',
    'Vous regardez : vous voyez ce que les autres modifient, et où ils sont. Pour modifier le diagramme vous-même, cessez de regarder ; votre copie est alors la vôtre.',
    'Está a ver: vê o que os outros alteram e onde estão. Para alterar o diagrama, deixe de ver; a sua cópia é então só sua.',
  ],
  'tog.name': ['Your name, as the others see it', 'Votre nom, tel que les autres le voient', 'O seu nome, como os outros o veem'],
  'tog.join': ['Work on it together', 'Y travailler à plusieurs', 'Trabalhar nele em conjunto'],
  'tog.look': ['Look', 'Regarder', 'Ver'],
  'tog.leave': ['Leave the others', 'Quitter les autres', 'Deixar os outros'],
  'tog.stop': ['Stop looking', 'Cesser de regarder', 'Deixar de ver'],
  'tog.people': ['People at this file', 'Personnes sur ce fichier', 'Pessoas neste ficheiro'],
  'tog.me': ['{name} (you)', '{name} (vous)', '{name} (você)'],
  'tog.nobody': ['Without a name', 'Sans nom', 'Sem nome'],
  'tog.edits': ['edits', 'modifie', 'altera'],
  'tog.views': ['looks', 'regarde', 'vê'],
  'tog.there': ['{names} work on {name} together.', '{names} travaillent ensemble sur {name}.', '{names} trabalham em conjunto em {name}.'],
  'tog.thereOne': ['{names} has {name} open to work on it together.', '{names} a ouvert {name} pour y travailler à plusieurs.', '{names} tem {name} aberto para trabalhar em conjunto.'],
  'tog.joined': ['{name} has joined.', "{name} s'est joint.", '{name} juntou-se.'],
  'tog.gone': ['{name} has left.', 'Départ de {name}.', '{name} saiu.'],
  'tog.looks': [
    'You look at the work of the others. Stop looking to change a copy of your own.',
    'Vous regardez le travail des autres. Cessez de regarder pour modifier votre propre copie.',
    'Está a ver o trabalho dos outros. Deixe de ver para alterar uma cópia sua.',
  ],
  'tog.kept': [
    'You have the text of the others now. Your changes are in “Unsaved work”.',
    'Vous avez maintenant le texte des autres. Vos modifications sont dans « Travail non enregistré ».',
    'Tem agora o texto dos outros. As suas alterações estão em «Trabalho por guardar».',
  ],
  'tog.guests': ['Address for guests, who look and change nothing', 'Adresse pour des invités, qui regardent et ne modifient rien', 'Endereço para convidados, que veem e não alteram nada'],
  'tog.noGuests': [
    'Guests look and change nothing. “g7 serve --guests” has an address for them.',
    "Les invités regardent et ne modifient rien. « g7 serve --guests » a une adresse pour eux.",
    'Os convidados veem e não alteram nada. «g7 serve --guests» tem um endereço para eles.',
  ],
  'tog.qr': ['QR code of the address for guests', "Code QR de l'adresse pour les invités", 'Código QR do endereço para convidados'],
  'tog.guest': ['Guest', 'Invité', 'Convidado'],
} as const satisfies Words;
