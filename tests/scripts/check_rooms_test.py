"""The room check accepts includes that point up the list and reports every other kind."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import check_rooms  # noqa: E402

ROOMS = "| room | holds |\n|---|---|\n| `base` | a |\n| `scene` | b |\n| `rays` | c |\n| `apps` | d |\n"


def offences(**files):
    """Offences in a tree whose files are given as path__with__slashes_cpp=text."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        files = {name.replace("__", "/").replace("_cpp", ".cpp"): text for name, text in files.items()}
        for name, text in {"docs/design/rooms.md": ROOMS, **files}.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return check_rooms.check(root)


class CheckRooms(unittest.TestCase):
    def test_an_earlier_room_may_be_included(self):
        self.assertEqual(offences(src__halflight__rays__a_cpp='#include "halflight/scene/s.h"\n'), [])

    def test_a_later_room_may_not(self):
        found = offences(src__halflight__scene__a_cpp='\n#include "halflight/rays/r.h"\n')
        self.assertEqual(len(found), 1)
        self.assertTrue(found[0].startswith("src/halflight/scene/a.cpp:2: "), found[0])

    def test_the_library_may_not_include_the_command_line(self):
        self.assertEqual(len(offences(src__halflight__rays__a_cpp='#include "halflight/apps/c.h"\n')), 1)

    def test_a_path_around_the_rooms_is_reported(self):
        self.assertEqual(len(offences(src__halflight__base__a_cpp='#include "../rays/r.h"\n')), 1)

    def test_only_the_command_line_may_include_experiments(self):
        line = '#include "experiments/e.h"\n'
        self.assertEqual(offences(apps__halflight__main_cpp=line), [])
        self.assertEqual(len(offences(src__halflight__base__a_cpp=line)), 1)

    def test_an_unlisted_room_is_reported(self):
        self.assertEqual(len(offences(src__halflight__attic__a_cpp="#include <vector>\n")), 1)

    def test_tbb_is_named_in_one_file_only(self):
        line = "#include <tbb/parallel_for.h>\n"
        self.assertEqual(offences(src__halflight__base__parallel_cpp=line), [])
        self.assertEqual(len(offences(src__halflight__base__other_cpp=line)), 1)
        self.assertEqual(len(offences(apps__halflight__main_cpp="#include <oneapi/tbb/task.h>\n")), 1)

    def test_embree_is_named_in_one_file_only(self):
        line = "#include <embree3/rtcore.h>\n"
        self.assertEqual(offences(src__halflight__rays__ray_scene_cpp=line), [])
        self.assertEqual(len(offences(src__halflight__rays__other_cpp=line)), 1)


if __name__ == "__main__":
    unittest.main()
