"""Substitutes for hardware that a host lacks: a kernel with CAN (``railhil vcan -- COMMAND``) and a serial adapter
(``python -m railhil.machines.adapter``)."""
