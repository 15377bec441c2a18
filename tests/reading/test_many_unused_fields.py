"""Notes on fields that are not used stay short, however many there are."""

from stiffmbs.reading.files.requested import MOST_FIELDS, Fields, unused_notes


def test_every_field_of_a_usual_file_is_named():
    (note,) = unused_notes([Fields("joint", str(k), {f"key{k}": 1}) for k in range(100)])
    assert all(f"key{k} " in note for k in range(100))


def test_a_great_many_fields_are_counted():
    found = Fields("[A]", "", {f"{'X' * 30_000}{k}": 1 for k in range(2 * MOST_FIELDS)})
    (note,) = unused_notes([found])
    assert note.endswith(f"and {MOST_FIELDS} more") and len(note) < 100 * MOST_FIELDS


def test_a_great_many_owners_are_counted():
    (note,) = unused_notes([Fields("joint", "Y" * 10_000 + str(k), {"friction": 1}) for k in range(1000)])
    assert "friction" in note and len(note) < 300
