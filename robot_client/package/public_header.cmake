# Writes the header FROM to TO with its includes from this tree's root turned into <scanloom/NAME.hpp>.
file(READ ${FROM} text)
string(REGEX REPLACE "#include \"[^\"]*/([^/\"]+)\"" "#include <scanloom/\\1>" text "${text}")
file(WRITE ${TO} "${text}")
