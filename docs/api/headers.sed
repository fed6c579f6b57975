# Prepares a header for doxygen, line by line, so that the line numbers of warnings are right.

# Labels of doc comments become sections (ALIASES in Doxyfile).
s;^( *///) +(Errors|Threads|Cost|Memory|Source|Precondition|Units|Frames|Usage): ;\1 @section_\2 ;

# Defaulted comparisons and moves need no description.
s;^ *friend .* operator(==|<=>).*= default\;$;;
s;^ *[A-Za-z]+(& operator=)?\([A-Za-z]+&&\) noexcept = default\;$;;
