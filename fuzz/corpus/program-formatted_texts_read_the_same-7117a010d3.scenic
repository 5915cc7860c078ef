class C: pass; x: None
