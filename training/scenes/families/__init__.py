"""Each module builds one kind of scene: build(scene, random, folders) places things, light and camera."""
NAMES = ("interior", "table_top", "scatter", "architecture", "vegetation", "terrain", "glass_metal", "typography", "dungeon", "street")
