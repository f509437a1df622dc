" Files of G7: charts as text.
autocmd BufNewFile,BufRead *.g7 setfiletype g7
