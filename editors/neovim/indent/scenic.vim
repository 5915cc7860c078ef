" Python's indentation; what goes on with specifiers after `new ...,` is indented like what stands in brackets.
if exists("b:did_indent")
  finish
endif
runtime! indent/python.vim
let b:did_indent = 1
setlocal indentexpr=ScenicIndent()
let b:undo_indent = "setlocal indentexpr<"

function! ScenicIndent() abort
  let previous = prevnonblank(v:lnum - 1)
  let line = substitute(getline(previous), '\s*\%(#.*\)\?$', '', '')
  if line =~# '\<new\>.*,$' || line =~# '^\s*override\>.*,$'
    return indent(previous) + shiftwidth()
  endif
  return exists("*python#GetIndent") ? python#GetIndent(v:lnum) : GetPythonIndent(v:lnum)
endfunction
