"""Opens a PLCopen XML file as Beremiz or OpenPLC does, and prints the text that its generator makes.

    plcopen_to_st.py FOLDER FILE
    plcopen_to_st.py FOLDER FILE FILE...

With several files, which is faster than a process for each, the text of each stands in FILE.st, and a line
for each is printed: empty, or the reason why it is refused.

FOLDER is a checkout of Beremiz or of OpenPLC's xml2st: both have the same modules. Only their
reader of projects and their generator are used; the window, the connections to a running
controller and the compiler are not needed. The exit code is 1 if the file is refused; the reason
is in the last line of the standard error.
"""

import builtins
import contextlib
import importlib.machinery
import sys
import types
import unittest.mock


class Absent:
    """Stands for every module that is not installed: those of the windows and of the network, which
    the generator never calls. It does call lxml."""

    def find_spec(self, name, _path=None, _target=None):
        if name.split(".")[0] == "lxml":
            return None
        return importlib.machinery.ModuleSpec(name, self, is_package=True)

    def create_module(self, _spec):
        module = unittest.mock.MagicMock()
        module.__path__ = []
        # It translates the reasons of the generator.
        module.GetTranslation = lambda text: text
        return module

    def exec_module(self, _module):
        pass


def started(folder):
    """The controller of projects and the generator."""
    sys.path.insert(0, folder)
    # Texts of the windows are translated by a function that their main program installs.
    builtins._ = lambda text: text
    # The drawing of the window, of which the controller takes names that it then does not use here.
    for name in ("graphics", "graphics.GraphicCommons"):
        sys.modules[name] = types.ModuleType(name)
    sys.meta_path.append(Absent())
    from PLCControler import PLCControler
    import PLCGenerator

    return PLCControler, PLCGenerator


def text(PLCControler, PLCGenerator, path):
    controller = PLCControler()
    try:
        result = controller.OpenXMLFile(path)
        if result is not None:
            raise SystemExit(f"refused by the reader: {result}")
        errors, warnings = [], []
        # OpenPLC's generator says on the standard output what it is doing.
        with contextlib.redirect_stdout(sys.stderr):
            chunks = PLCGenerator.GenerateCurrentProgram(controller, controller.Project, errors, warnings)
    except Exception as problem:
        raise SystemExit(f"refused by the generator: {type(problem).__name__}: {problem}")
    for problem in errors:
        print(problem, file=sys.stderr)
    return "".join(chunk[0] for chunk in chunks)


def main(folder, paths):
    peer = started(folder)
    if len(paths) == 1:
        sys.stdout.write(text(*peer, paths[0]))
        return
    for path in paths:
        try:
            made = text(*peer, path)
            with open(path + ".st", "w", encoding="utf-8") as file:
                file.write(made)
            print()
        except SystemExit as reason:
            print(str(reason).replace("\n", " "))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
