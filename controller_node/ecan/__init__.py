"""The CAN module of the TMS320F28335 (eCAN) as far as a controller notices it: mailboxes, losses, time stamps."""

from controller_node.ecan.module import Ecan
from controller_node.ecan.receiver import Receiver
from controller_node.ecan.table import Mailbox, mailbox_table
from controller_node.ecan.timestamp import BitCounter, MessageAge

__all__ = ["BitCounter", "Ecan", "Mailbox", "MessageAge", "Receiver", "mailbox_table"]
