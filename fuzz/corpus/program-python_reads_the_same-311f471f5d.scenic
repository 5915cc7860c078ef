f'' u'x'
