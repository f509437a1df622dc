" Settings of a .g7 file; in Neovim also the language server, `g7 lsp`.
if exists('b:did_ftplugin')
  finish
endif
let b:did_ftplugin = 1

setlocal commentstring=//\ %s comments=s1:/*,mb:*,ex:*/,:// suffixesadd=.g7
setlocal expandtab shiftwidth=2 softtabstop=2 autoindent smartindent
setlocal foldmethod=syntax foldlevel=99
let b:undo_ftplugin = 'setlocal commentstring< comments< suffixesadd< expandtab< shiftwidth< softtabstop< autoindent< smartindent< foldmethod< foldlevel<'

" `let g:g7_lsp = 0` leaves the server out; `let g:g7_program = '…'` names the program.
if has('nvim') && get(g:, 'g7_lsp', 1) && executable(get(g:, 'g7_program', 'g7'))
  lua require('g7').start()
endif
