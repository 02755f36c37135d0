/* Names the readings and commands for which a shared library is made: another bench refuses it. */
extern const char @NAME@_interface[];
const char @NAME@_interface[] = "@INTERFACE@";
