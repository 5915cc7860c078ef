au BufNewFile,BufRead *.scenic,*.sc setfiletype scenic
