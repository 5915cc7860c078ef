au BufNewFile,BufRead *.scenic setfiletype scenic
