# SPDX-License-Identifier: BSD-3-Clause
"""Areas of headers, and of sources, from which mutants are taken evenly, and which tests should see one, the quickest first.

A test is the path of its source below tests/, without `_test.cpp`. A header's own tests come from the last pattern that
matches its path below include/clearance/. Headers for devices (.cuh) are left out: no host compiles them.
"""

import fnmatch

AREAS = ["ground", "volume", "primitive", "frames", "scan", "answers", "cloud_tree", "io", "solid"]
COMPILED = {"io": "src/io", "solid": "src/solid"}  # and their sources
FOLDERS = {"answers": ["questions", "minimum", "pairwise", "pointwise", "concepts"]}  # else a folder of the area's name
HALF_DEVICE = ["scan/block.cuh"]  # read by kernels alone

ASKED = ["frames/bracket", "minimum/minimum", "minimum/prepared", "questions/distances", "questions/unseen"]
TESTS = {
    "*": ASKED,
    "ground/*": ["primitive/primitives", "volume/volumes", "minimum/minimum", "minimum/prepared", "frames/far"],
    "ground/pose.hpp": ["minimum/merge", "io/joint_chain", "minimum/minimum", "frames/far"],
    "ground/chain_rounding.hpp": ["io/joint_chain", "io/robot_words", "io/kinematics"],
    "ground/vectors.hpp": ["questions/distances", "scan/tangents"],
    "ground/ordered.hpp": ["primitive/primitives", "minimum/minimum", "minimum/prepared"],
    "robot/joint_chain.hpp": ["io/joint_chain"],
    "primitive/*": ["primitive/primitives", "bounds/bounds", "scan/tangents", "minimum/minimum", "questions/unseen"],
    "primitive/triangle.hpp": ["primitive/primitives", "questions/unseen"],
    "volume/*": ["volume/volumes", "bounds/bounds", "bvh/build", "scan/tangents", "minimum/minimum"],
    "frames/*": ["frames/bracket", "frames/far", "frames/too_close", "minimum/merge", "questions/in_collision",
                 "minimum/minimum"],
    "frames/bracket.hpp": ["frames/bracket", "frames/too_close", "frames/far", "minimum/merge",
                           "questions/distances", "clearance/deadline"],
    "frames/margins.hpp": ["questions/in_collision", "questions/distances", "questions/within", "frames/bracket"],
    "frames/mapped_clouds.hpp": ["questions/self_filter", "clearance/deadline", "minimum/minimum"],
    "frames/root_test.hpp": ["frames/root_test", "bounds/bounds", "frames/bracket", "minimum/minimum",
                             "questions/unseen"],
    "scan/*": ["minimum/prepared", "minimum/minimum", "questions/distances", "scan/tangents", "questions/unseen"],
    "scan/tile_scan.hpp": ["scan/capsule_tiles", "bounds/bounds", "questions/unseen"],
    "scan/element.hpp": ["questions/unseen", "frames/bracket", "minimum/prepared"],
    "scan/group_walk.hpp": ["questions/distances", "scan/tangents"],
    "scan/packet.hpp": ["questions/distances", "scan/tangents"],
    "scan/boxes.hpp": ["clearance/chunked_query", "questions/uncertain_forms"],
    "scan/seen_memory.hpp": ["questions/distances", "scan/tangents"],
    "scan/yardstick.hpp": ["bounds/bounds", "questions/distances", "scan/tangents"],
    "scan/interior.hpp": ["frames/bracket", "questions/distances"],
    "concepts/capsule.hpp": ["primitive/primitives", "bounds/bounds", "questions/unseen"],
    "concepts/tree.hpp": ["minimum/minimum", "bvh/build", "questions/min_distances"],
    "concepts/tangent.hpp": ["scan/tangents", "volume/volumes"],
    "minimum/*": ["frames/bracket", "minimum/minimum", "minimum/prepared", "minimum/merge", "frames/too_close"],
    "minimum/field_sample.hpp": ["clearance/fields", "minimum/prepared"],
    "minimum/chunked*.hpp": ["clearance/chunked_query", "questions/uncertain_forms"],
    "minimum/merge.hpp": ["clearance/deadline", "minimum/merge"],
    "minimum/shared_bounds.hpp": ["minimum/prepared", "clearance/deadline"],
    "questions/*": ["questions/distances", "questions/within"],
    "questions/min_distances*.hpp": ["questions/min_distances"],
    "questions/certain_distance.hpp": ["questions/uncertain_forms", "questions/uncertain"],
    "questions/self_filter.hpp": ["questions/self_filter"],
    "questions/min_distance_supported.hpp": ["questions/min_distance_supported"],
    "questions/collect.hpp": ["questions/collect"],
    "questions/distances.hpp": ["questions/distances"],
    "questions/distances_per_part.hpp": ["questions/distances_per_part"],
    "questions/in_collision.hpp": ["questions/in_collision"],
    "questions/in_collisions.hpp": ["questions/min_distances"],
    "questions/min_distance.hpp": ["frames/bracket", "minimum/minimum", "frames/too_close"],
    "questions/min_distance_filtered.hpp": ["questions/self_filter"],
    "questions/nearest_k.hpp": ["questions/nearest_k"],
    "questions/nearest_points.hpp": ["questions/nearest_k", "questions/min_distance_supported"],
    "questions/part_witnesses.hpp": ["clearance/gradient"],
    "questions/signed_distances.hpp": ["questions/signed_distances"],
    "questions/unseen.hpp": ["questions/unseen"],
    "questions/within.hpp": ["questions/within", "frames/too_close"],
    "questions/zones.hpp": ["questions/zones"],
    "pairwise/*": ["questions/within", "questions/nearest_k", "questions/zones", "questions/in_collision"],
    "pairwise/nearest_*.hpp": ["questions/nearest_k"],
    "pointwise/*": ["questions/distances", "questions/distances_per_part", "questions/signed_distances"],
    "pointwise/cell_*.hpp": ["clearance/cells"],
    "cloud_tree/*": ["questions/min_distances"],
    "cloud_tree/host_tree.hpp": ["bounds/bounds", "questions/min_distances"],
    "cloud_tree/tree_view.hpp": ["questions/min_distances", "questions/radii", "cloud_tree/pixel_order"],
    "solid/*": ["solid/close_mesh", "solid/inside", "packing/pack"],
    "solid/winding.hpp": ["solid/winding", "solid/inside"],
    "solid/rays.hpp": ["solid/inside", "solid/close_mesh"],
    "solid/flood.hpp": ["solid/inside", "solid/close_mesh"],
    "solid/boundary.hpp": ["solid/cap", "solid/close_mesh"],
    "solid/polygon.hpp": ["solid/cap", "solid/close_mesh"],
    "solid/box_tree.hpp": ["solid/mesh_solid", "packing/pack"],
    "solid/mesh_solid.hpp": ["solid/mesh_solid", "packing/pack"],
    "solid/pack.hpp": ["packing/pack", "packing/several"],
    "solid/eight.hpp": ["packing/eight", "packing/pack"],
    "io/*": ["io/robot", "io/mesh", "io/robot_damage"],
    "io/compressed_depth.hpp": ["io/compressed_depth"],
    "io/file_beside.hpp": ["io/gltf", "io/mesh_paths"],
    "io/glb_writer.hpp": ["io/scene"],
    "io/spheres_yaml.hpp": ["io/spheres"],
    "io/mesh_dae.hpp": ["io/mesh", "io/mesh_damage"],
    "io/mesh_gltf.hpp": ["io/gltf", "io/mesh_damage"],
    "io/cloud*.hpp": ["io/cloud", "io/text_lines"],
    "io/field*.hpp": ["io/fields_file"],
    "io/gltf*.hpp": ["io/gltf", "io/mesh_damage", "io/scene"],
    "io/mapped_*.hpp": ["io/mapped", "io/cloud"],
    "io/mesh*.hpp": ["io/mesh", "io/mesh_damage", "io/hostile_size"],
    "io/pcd*.hpp": ["io/pcd", "io/text_lines", "io/read_limits", "io/cloud"],
    "io/ply*.hpp": ["io/ply", "io/text_lines", "io/cloud"],
    "io/png*.hpp": ["io/depth", "io/read_limits"],
    "io/robot*.hpp": ["io/robot", "io/robot_words", "io/robot_damage"],
    "io/scene*.hpp": ["io/scene"],
    "io/spheres_*.hpp": ["io/spheres", "io/packing_cache"],
    "io/urdf*.hpp": ["io/robot_words", "io/robot", "io/robot_damage"],
    "io/bytes.hpp": ["io/ply", "io/pcd", "io/mesh_damage"],
    "io/robot_bodies.hpp": ["io/packing_cache", "io/spheres"],
    "io/dae_mesh.hpp": ["io/mesh", "io/mesh_damage"],
    "io/digest.hpp": ["io/ist", "io/packing_cache"],
    "io/scene.hpp": ["io/ply_writer", "io/scene"],
    "io/error.hpp": ["io/cloud", "io/read_limits", "io/mapped"],
    "io/hidden_mesh.hpp": ["io/scene"],
    "io/ist.hpp": ["io/ist"],
    "io/jacobian.hpp": ["io/jacobian"],
    "io/joint_chain.hpp": ["io/joint_chain"],
    "io/joint_motion.hpp": ["io/joint_motion"],
    "io/kept_files.hpp": ["io/packing_cache", "io/fields_file"],
    "io/kinematics.hpp": ["io/kinematics", "io/robot_words", "io/joint_chain", "io/free_joints"],
    "io/mesh_obj.hpp": ["io/obj", "io/mesh", "io/mesh_damage", "io/text_lines"],
    "io/mesh_ply.hpp": ["io/ply", "io/mesh"],
    "io/near_word.hpp": ["io/robot_words", "io/spheres"],
    "io/note_tally.hpp": ["io/robot_words"],
    "io/package.hpp": ["io/robot", "io/mesh_paths"],
    "io/packed_part.hpp": ["io/packing_cache"],
    "io/packing_cache.hpp": ["io/packing_cache"],
    "io/packing_scene.hpp": ["io/scene"],
    "io/part_radii.hpp": ["io/part_radii"],
    "io/ply_writer.hpp": ["io/ply_writer"],
    "io/robot.hpp": ["io/robot_gltf"],
    "io/sealed_file.hpp": ["io/ist", "io/fields_file"],
    "io/sentence.hpp": ["io/cloud", "io/robot_damage", "io/mesh"],
    "io/srdf.hpp": ["io/srdf"],
    "io/stamped_joints.hpp": ["io/part_radii"],
    "io/robot_link.hpp": ["io/robot"],
    "io/text_file.hpp": ["io/text_file"],
    "io/uri.hpp": ["io/mesh_paths", "io/gltf"],
    "io/urdf.hpp": ["io/free_joints", "io/robot"],
    "io/write_file.hpp": ["io/write_file", "io/ply_writer"],
    "io/xml.hpp": ["io/robot_damage", "io/mesh_damage", "io/hostile_size"],
    "io/cloud_file.hpp": ["io/cloud", "io/text_lines"],
}


def areas(folder):
    """The headers of each area, below include/clearance (`folder`), and its sources, below the checkout (src/...)."""
    root = folder.parents[1]

    def of(area):
        headers = [path.relative_to(folder) for name in FOLDERS.get(area, [area]) for path in sorted((folder / name).glob("*.hpp"))]
        sources = [path.relative_to(root) for path in sorted((root / COMPILED[area]).glob("*.[ch]pp"))] if area in COMPILED else []
        return [str(path) for path in headers + sources if str(path) not in HALF_DEVICE]

    return {area: of(area) for area in AREAS}


def tests_of(header):
    """A source has the tests of a header of its name."""
    header = header.removeprefix("src/").removesuffix(".cpp").removesuffix(".hpp") + ".hpp"
    return [tests for pattern, tests in TESTS.items() if fnmatch.fnmatch(header, pattern)][-1]
