"""``python -m supervisor.cli`` is ``railhil``."""

import sys

from supervisor.cli import main

sys.exit(main())
