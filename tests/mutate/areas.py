# SPDX-License-Identifier: BSD-3-Clause
"""Areas of headers from which mutants are taken evenly, and which tests should see a header, the quickest first.

A test is the path of its source below tests/, without `_test.cpp`. A header's own tests come from the last pattern that
matches its path below include/clearance/. Headers for devices (.cuh) are left out: no host compiles them.
"""

import fnmatch

AREAS = ["ground", "volume", "primitive", "frame", "scan", "answers", "cloud_tree", "io"]
FOLDERS = {"answers": ["questions", "minimum", "pairwise", "pointwise", "concepts"]}  # else a folder of the area's name
HALF_DEVICE = ["scan/nodes.hpp"]  # read by kernels alone

ASKED = ["search/bracket", "search/minimum", "search/prepared", "search/distances", "search/unseen"]
TESTS = {
    "*": ASKED,
    "ground/*": ["primitive/primitives", "volume/volumes", "search/minimum", "search/prepared", "search/far"],
    "ground/pose.hpp": ["search/merge", "io/joint_chain", "search/minimum", "search/far"],
    "ground/sine.hpp": ["io/joint_chain"],
    "ground/chain_rounding.hpp": ["io/joint_chain", "io/robot_words", "io/kinematics"],
    "ground/vectors.hpp": ["search/distances", "search/tangents"],
    "ground/segments.hpp": ["primitive/primitives", "search/unseen"],
    "ground/ordered.hpp": ["primitive/primitives", "search/minimum", "search/prepared"],
    "volume/*": ["volume/volumes", "bounds/bounds", "bvh/build", "search/tangents", "search/minimum"],
    "primitive/*": ["primitive/primitives", "bounds/bounds", "search/tangents", "search/minimum", "search/unseen"],
    "frame/*": ["search/bracket", "search/far", "search/too_close", "search/merge", "search/collision",
                "search/minimum"],
    "frame/bracket.hpp": ["search/bracket", "search/too_close", "search/far", "search/merge", "search/distances"],
    "frame/margins.hpp": ["search/collision", "search/distances", "search/within", "search/bracket"],
    "frame/masked_clouds.hpp": ["search/self_filter"],
    "frame/mapped_clouds.hpp": ["search/self_filter", "search/min_distance_by", "search/minimum"],
    "frame/root_test.hpp": ["search/root_test", "bounds/bounds", "search/bracket", "search/minimum", "search/unseen"],
    "scan/*": ["search/prepared", "search/minimum", "search/distances", "search/tangents", "search/unseen"],
    "scan/capsule_tiles.hpp": ["search/capsule_tiles", "bounds/bounds", "search/unseen"],
    "scan/element.hpp": ["search/unseen", "search/bracket", "search/prepared"],
    "scan/group_walk.hpp": ["search/distances", "search/tangents"],
    "scan/neighbours.hpp": ["search/distances", "search/tangents"],
    "scan/packet.hpp": ["search/distances", "search/tangents"],
    "scan/boxes.hpp": ["search/chunked", "search/uncertain_forms"],
    "scan/seen_memory.hpp": ["search/distances", "search/tangents"],
    "scan/yardstick.hpp": ["bounds/bounds", "search/distances", "search/tangents"],
    "scan/interior.hpp": ["search/bracket", "search/distances"],
    "concepts/capsule.hpp": ["primitive/primitives", "bounds/bounds", "search/unseen"],
    "concepts/tree.hpp": ["search/minimum", "bvh/build", "search/min_distances"],
    "concepts/tangent.hpp": ["search/tangents", "volume/volumes"],
    "minimum/*": ["search/bracket", "search/minimum", "search/prepared", "search/merge", "search/too_close"],
    "minimum/certain_pairs.hpp": ["search/uncertain_forms", "search/uncertain"],
    "minimum/chunked*.hpp": ["search/chunked", "search/uncertain_forms"],
    "minimum/of_pieces.hpp": ["search/min_distance_by"],
    "minimum/merge.hpp": ["search/merge", "search/min_distance_by"],
    "minimum/beyond.hpp": ["search/min_distance_by", "search/bracket"],
    "minimum/field_sample.hpp": ["search/fields", "search/prepared"],
    "minimum/shared_bounds.hpp": ["search/prepared", "search/min_distance_by"],
    "pairwise/*": ["search/within", "search/nearest_k", "search/zones", "search/collision"],
    "pairwise/nearest_*.hpp": ["search/nearest_k"],
    "pairwise/own_points.hpp": ["search/self_filter"],
    "pairwise/support.hpp": ["search/min_support"],
    "pointwise/*": ["search/distances", "search/distances_per_part", "search/signed_distances"],
    "pointwise/cell_*.hpp": ["search/cells"],
    "questions/*": ["search/distances", "search/within"],
    "questions/certain_distance.hpp": ["search/uncertain"],
    "questions/collect.hpp": ["search/collect"],
    "questions/distances.hpp": ["search/distances"],
    "questions/distances_per_part.hpp": ["search/distances_per_part"],
    "questions/in_collision.hpp": ["search/collision"],
    "questions/in_collisions.hpp": ["search/min_distances"],
    "questions/min_distance.hpp": ["search/bracket", "search/minimum", "search/too_close"],
    "questions/min_distance_filtered.hpp": ["search/self_filter"],
    "questions/min_distance_supported.hpp": ["search/min_support"],
    "questions/min_distances*.hpp": ["search/min_distances"],
    "questions/nearest_k.hpp": ["search/nearest_k"],
    "questions/nearest_points.hpp": ["search/nearest_k", "search/min_support"],
    "questions/part_witnesses.hpp": ["search/gradient"],
    "questions/self_filter.hpp": ["search/self_filter"],
    "questions/signed_distances.hpp": ["search/signed_distances"],
    "questions/unseen.hpp": ["search/unseen"],
    "questions/within.hpp": ["search/within", "search/too_close"],
    "questions/zones.hpp": ["search/zones"],
    "cloud_tree/*": ["search/min_distances"],
    "cloud_tree/host_tree.hpp": ["bounds/bounds", "search/min_distances"],
    "cloud_tree/tree_view.hpp": ["search/min_distances", "search/radii"],
    "cloud_tree/pixel_order.hpp": ["search/pixel_order"],  # of images only kernels make trees
    "io/*": ["io/robot", "io/mesh", "io/robot_damage"],
    "io/bytes.hpp": ["io/ply", "io/pcd", "io/mesh_damage"],
    "io/certify.hpp": ["io/packing_cache", "io/spheres"],
    "io/cloud*.hpp": ["io/cloud", "io/text_lines"],
    "io/dae_mesh.hpp": ["io/mesh", "io/mesh_damage"],
    "io/depth.hpp": ["io/depth"],
    "io/digest.hpp": ["io/ist", "io/packing_cache"],
    "io/distance_colour.hpp": ["io/ply_writer"],
    "io/error.hpp": ["io/cloud", "io/read_limits", "io/mapped"],
    "io/field*.hpp": ["io/fields_file"],
    "io/glb_data.hpp": ["io/mesh", "io/mesh_damage", "io/scene"],
    "io/glb_writer.hpp": ["io/scene"],
    "io/gltf_json.hpp": ["io/mesh_damage", "io/mesh"],
    "io/hidden_mesh.hpp": ["io/scene"],
    "io/ist.hpp": ["io/ist"],
    "io/jacobian.hpp": ["io/jacobian"],
    "io/joint_chain.hpp": ["io/joint_chain"],
    "io/joint_motion.hpp": ["io/joint_motion"],
    "io/kept_files.hpp": ["io/packing_cache", "io/fields_file"],
    "io/kinematics.hpp": ["io/kinematics", "io/robot_words", "io/joint_chain"],
    "io/mapped_*.hpp": ["io/mapped", "io/cloud"],
    "io/mesh*.hpp": ["io/mesh", "io/mesh_damage", "io/hostile_size"],
    "io/mesh_obj.hpp": ["io/obj", "io/mesh", "io/mesh_damage", "io/text_lines"],
    "io/mesh_ply.hpp": ["io/ply", "io/mesh"],
    "io/near_word.hpp": ["io/robot_words"],
    "io/note_tally.hpp": ["io/robot_words"],
    "io/package.hpp": ["io/robot"],
    "io/packed_part.hpp": ["io/packing_cache"],
    "io/packing_cache.hpp": ["io/packing_cache"],
    "io/packing_scene.hpp": ["io/scene"],
    "io/part_radii.hpp": ["io/part_radii"],
    "io/pcd*.hpp": ["io/pcd", "io/text_lines", "io/read_limits", "io/cloud"],
    "io/ply*.hpp": ["io/ply", "io/text_lines", "io/cloud"],
    "io/ply_writer.hpp": ["io/ply_writer"],
    "io/png*.hpp": ["io/depth", "io/read_limits"],
    "io/robot*.hpp": ["io/robot", "io/robot_words", "io/robot_damage"],
    "io/scene*.hpp": ["io/scene"],
    "io/sealed_file.hpp": ["io/ist", "io/fields_file"],
    "io/sentence.hpp": ["io/cloud", "io/robot_damage", "io/mesh"],
    "io/spheres_*.hpp": ["io/spheres", "io/packing_cache"],
    "io/stamped_joints.hpp": ["io/part_radii"],
    "io/tessellate.hpp": ["io/robot"],
    "io/urdf*.hpp": ["io/robot_words", "io/robot", "io/robot_damage"],
    "io/write_file.hpp": ["io/write_file", "io/ply_writer"],
    "io/xml.hpp": ["io/robot_damage", "io/mesh_damage", "io/hostile_size"],
    "io/xyz.hpp": ["io/cloud", "io/text_lines"],
    "io/yaml_check.hpp": ["io/spheres"],
}


def areas(folder):
    """The headers of each area, below include/clearance."""
    return {
        area: [
            header
            for name in FOLDERS.get(area, [area])
            for header in sorted(str(path.relative_to(folder)) for path in (folder / name).glob("*.hpp"))
            if header not in HALF_DEVICE
        ]
        for area in AREAS
    }


def tests_of(header):
    return [tests for pattern, tests in TESTS.items() if fnmatch.fnmatch(header, pattern)][-1]
