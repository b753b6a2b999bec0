# SPDX-License-Identifier: BSD-3-Clause
"""Where a rank dies, all end, none with an answer, and the exit code says so.
Arguments: mpiexec, its option for the number of ranks, test_mpi."""
import os
import subprocess
import sys

mpiexec, number, program = sys.argv[1:]
environment = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                            "OMPI_MCA_rmaps_base_oversubscribe": "1"}
for ranks, how in ((2, "killed"), (3, "inside"), (3, "quits"), (2, "aborts"), (2, "none")):
    ended = subprocess.run([mpiexec, number, str(ranks), program, "The last rank dies while the others ask"],
                           env=environment | {"CLEARANCE_TEST_DIES": how}, capture_output=True, text=True, timeout=100)
    answers = ended.stdout.count("an answer")
    assert "all live" in ended.stdout, f"{how}: {ended.stdout}{ended.stderr}"
    if how == "none":
        assert (ended.returncode, answers) == (0, ranks), f"{ended.returncode}, {answers} answers: {ended.stderr}"
    else:
        assert ended.returncode != 0 and answers == 0, f"{how}: ends with {ended.returncode}, {answers} answers"
