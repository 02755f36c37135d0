"""``python -m railhil.cli`` is ``railhil``."""

import sys

from railhil.cli import main

sys.exit(main())
