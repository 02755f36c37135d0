"""The CAN module of the TMS320F28335 (eCAN) in the parts that affect a controller: mailboxes, losses, time stamps."""

from railhil.controller_node.ecan.mailboxes import Mailbox, mailbox_table
from railhil.controller_node.ecan.module import Ecan
from railhil.controller_node.ecan.receiver import Receiver
from railhil.controller_node.ecan.timestamp import BitCounter, MessageAge

__all__ = ["BitCounter", "Ecan", "Mailbox", "MessageAge", "Receiver", "mailbox_table"]
