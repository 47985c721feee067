# [#V] is a number of vertices in our headers, and a link in Doxygen's: within comments, # stands for itself.
:next
s@\(///.*[^\\]\)#@\1\\#@
t next
