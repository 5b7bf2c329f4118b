"""Write the tables of words and both JSON Schemas into the docs: ``python docs/words.py``."""

from pathlib import Path

from trajgap.compare.audits import RULES
from trajgap.compare.documents import write_docs

if __name__ == "__main__":
    write_docs(Path(__file__).parent, RULES)
