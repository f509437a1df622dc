"""Holds XML files against a schema by lxml, which is what xmllint does.

    schema.py SCHEMA FILE...

For each file the answer is a line: empty, or `refused: ` and the first complaint.
"""

import sys

from lxml import etree

schema = etree.XMLSchema(etree.parse(sys.argv[1]))
for name in sys.argv[2:]:
    try:
        schema.assertValid(etree.parse(name))
        print()
    except (etree.DocumentInvalid, etree.XMLSyntaxError) as error:
        print("refused:", " ".join(str(error).split()))
