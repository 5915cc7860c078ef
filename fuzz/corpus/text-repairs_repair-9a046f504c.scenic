M if front \
    of \
   - new Object \
     contained in M else \
   M \
     ;  # comment
 with M not visible from M: pass  # comment
