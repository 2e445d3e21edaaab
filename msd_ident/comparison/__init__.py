"""Which parameters do several robots, joints or days share, which one differs, and how surely?"""
