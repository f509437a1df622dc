"""Loads charts in XMI by pyecore, with the meta-model of their maker.

    xmi_read.py FOLDER FILE...

The folder holds `grafcet.ecore` and `terms.ecore`. For each file the answer is a line: how many objects the model
has, or `refused: ` and the complaint of pyecore. Every object and every reference is visited, so that what is resolved
late is resolved too.
"""

import pathlib
import sys

from pyecore.resources import ResourceSet, URI

folder = pathlib.Path(sys.argv[1])
resources = ResourceSet()
for name in ("terms.ecore", "grafcet.ecore"):
    package = resources.get_resource(URI(str(folder / name))).contents[0]
    resources.metamodel_registry[package.nsURI] = package
    # The name that files have for it.
    resources.metamodel_registry["http://www.example.org/" + package.name] = package


def visited(thing):
    """The number of objects in a tree. What a rule of the meta-model asks for and is not there is an error."""
    for feature in thing.eClass.eAllStructuralFeatures():
        value = thing.eGet(feature)
        if feature.many:
            value = list(value)
            count = len(value)
        else:
            count = int(value is not None)
        if feature.required and count == 0:
            raise ValueError(f"{thing.eClass.name} without {feature.name}")
    return 1 + sum(visited(part) for part in thing.eContents)


for name in sys.argv[2:]:
    try:
        model = resources.get_resource(URI(name))
        print(sum(visited(root) for root in model.contents))
    except Exception as error:
        print("refused:", type(error).__name__, " ".join(str(error).split()))
